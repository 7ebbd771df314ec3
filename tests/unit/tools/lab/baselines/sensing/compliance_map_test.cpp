#include "tools/lab/baselines/sensing/compliance_map.hpp"

#include <gtest/gtest.h>

#include "tests/unit/tools/lab/baselines/seen_bar.hpp"

namespace palpate::baselines {
namespace {

using Eigen::Vector3d;

// Caccamo et al. 2016: a surface that is stiff at one end and soft at the other, touched at the
// point of highest uncertainty: the map approaches the truth everywhere, and its uncertainty
// indicates where it does not.
TEST(ComplianceProcessTest, MapsASurfaceByTouchingWhereItIsKnownLeast) {
  const auto truth = [](const Vector3d& p) { return 1e-3 * std::exp(p.x() / 0.1); };
  Eigen::Matrix3Xd places(3, 60);
  for (int i = 0; i < 60; ++i) places.col(i) << 0.2 * (i % 20) / 19, 0.03 * (i / 20), 0;
  ComplianceProcess process(ComplianceProcess::Options{});
  EXPECT_NEAR(process.at(places.col(0)).deviation, 1, 1e-9);
  double before = 0;
  for (int touches = 0; touches < 24; ++touches) {
    const Eigen::Index next = process.least_known(places);
    process.add(places.col(next), truth(places.col(next)));
    double worst = 0;
    for (int i = 0; i < 60; ++i) worst = std::max(worst, process.at(places.col(i)).deviation);
    if (touches > 0) {
      EXPECT_LE(worst, before + 1e-9);
    }
    before = worst;
  }
  EXPECT_LT(before, 0.5);
  for (int i = 0; i < 60; ++i)
    EXPECT_NEAR(std::log(process.at(places.col(i)).compliance / truth(places.col(i))), 0, 0.3);
  // Far from every touch it equals the prior.
  EXPECT_NEAR(process.at({1, 1, 1}).deviation, 1, 1e-6);
  EXPECT_NEAR(process.at({1, 1, 1}).compliance, 1e-3, 1e-9);
}

// For one touch the posterior is known in closed form.
TEST(ComplianceProcessTest, OneTouchGivesTheClosedForm) {
  ComplianceProcess::Options options;
  ComplianceProcess process(options);
  process.add(Vector3d::Zero(), 4e-3);
  const double k = std::exp(-0.5), n = options.noise * options.noise;
  const auto found = process.at({options.length, 0, 0});
  EXPECT_NEAR(std::log(found.compliance / options.mean), k / (1 + n) * std::log(4), 1e-12);
  EXPECT_NEAR(found.deviation, std::sqrt(1 - k * k / (1 + n)), 1e-12);
}

TEST(ComplianceProcessTest, MoreTouchesThanRoomAreNoTrouble) {
  ComplianceProcess process(ComplianceProcess::Options{});
  math::Random random(2);
  for (int i = 0; i < 500; ++i)
    process.add({random.uniform(), random.uniform(), random.uniform()}, 2e-3);
  EXPECT_EQ(process.count(), ComplianceProcess::kMost);
  EXPECT_TRUE(std::isfinite(process.at({0.5, 0.5, 0.5}).compliance));
  process.add({0, 0, 0}, -1);  // nothing is that compliant
  EXPECT_EQ(process.count(), ComplianceProcess::kMost);
}

TEST(ComplianceMapTest, ATouchMovesTheSurfaceAboutIt) {
  const elasticity::Body body = support::held_bar({10, 2, 2}, mesh::ElementOrder::kLinear);
  ComplianceMap map(body, mesh::extract_surface(body.mesh), {});
  const auto model = support::carrier(body);
  model->prepare();
  map.activate(*model);
  contact::ContactLoads touch;
  touch.source = sensing::Source::kManual;
  touch.accepted = true;
  touch.location << 0.25, 0.03, 0.056;  // 4 mm deep
  int middle = 0;
  (body.mesh.nodes.colwise() - Vector3d(0.25, 0.03, 0.06)).colwise().norm().minCoeff(&middle);
  touch.loads.push_back({middle, {0, 0, -0.5}});
  estimation::EstimationInputs inputs;
  estimation::Estimate estimate;
  inputs.contact_count = 1;
  inputs.contacts = &touch;
  for (int i = 0; i < 500; ++i) {
    const loop::NoAllocationScope scope;
    static_cast<void>(map.update(inputs, *model, estimate));
    EXPECT_EQ(scope.count(), 0);
  }
  EXPECT_EQ(map.process().count(), 1);
  EXPECT_NEAR(map.process().at({0.25, 0.03, 0.06}).compliance, 8e-3, 1e-3);
  EXPECT_NEAR(model->positions()(2, middle), 0.056, 5e-4);
  EXPECT_NEAR(model->positions()(2, 0), body.mesh.nodes(2, 0), 1e-9);
}

}  // namespace
}  // namespace palpate::baselines
