#include "core/estimation/fingertip_driven.hpp"

#include <gtest/gtest.h>

#include "core/elasticity/corotational_model.hpp"
#include "tests/unit/core/estimation/rigid_model.hpp"

namespace palpate::estimation {
namespace {

using Eigen::Vector3d;
using sensing::Source;

/// A bar of 0.5 x 0.06 x 0.06 m, clamped at x = 0, weightless, with one finger below.
class FingertipDrivenTest : public ::testing::Test {
 protected:
  FingertipDrivenTest() {
    body_.grasps.clear();
    body_.gravity_O.setZero();
    surface_ = mesh::extract_surface(body_.mesh);
    model_ = std::make_unique<elasticity::CorotationalQuasistatic>(body_);
    estimator_ = std::make_unique<FingertipDriven>(body_, surface_, options_);
    model_->prepare();
    estimator_->activate(*model_);
    contact_.source = Source::kFinger1;
    contact_.accepted = true;
    contact_.loads.push_back({0, Vector3d(0, 0, 1)});  // measured: 1 N
    inputs_.contact_count = 1;
    inputs_.contacts = &contact_;
  }

  /// The finger keeps contact at `place` for `ticks`.
  UpdateResult run(const Vector3d& place, int ticks) {
    contact_.location = place;
    UpdateResult result;
    for (int i = 0; i < ticks; ++i) {
      result = estimator_->update(inputs_, *model_, estimate_);
      if (elasticity::Refactorisation* job = model_->wanted_refactorisation()) {
        job->run();
        model_->install(*job);
      }
    }
    return result;
  }

  /// Current position of the material whose rest position is at a node.
  Vector3d node_at(const Vector3d& rest) const {
    const std::vector<int> nodes = mesh::nodes_in_box(body_.mesh, rest, rest);
    return model_->positions().col(nodes.at(0));
  }

  elasticity::Body body_ = support::held_bar({8, 2, 2}, mesh::ElementOrder::kQuadratic);
  mesh::Surface surface_;
  FingertipDriven::Options options_;
  std::unique_ptr<elasticity::CorotationalQuasistatic> model_;
  std::unique_ptr<FingertipDriven> estimator_;
  contact::ContactLoads contact_;
  EstimationInputs inputs_;
  Estimate estimate_;
};

const Vector3d kBelow(0.5, 0.03, 0);  // middle of the lower edge of the free end

TEST_F(FingertipDrivenTest, MaterialGoesWhereTheFingerIs) {
  static_cast<void>(run(kBelow, 200));  // touches without force
  EXPECT_LT(estimator_->force(1).norm(), 1e-6);
  const UpdateResult result = run(kBelow + Vector3d(0, 0, 0.02), 1000);
  EXPECT_EQ(result.status, Status::kOk) << result.reason;
  const Vector3d force = estimator_->force(1);
  EXPECT_GT(force.z(), 0);
  const Vector3d left = kBelow + Vector3d(0, 0, 0.02) - node_at(kBelow);
  EXPECT_LT((left - force / options_.skin_stiffness).norm(), 1e-5);
}

TEST_F(FingertipDrivenTest, NeedsTheForceOfABeam) {
  options_.friction = 0.01;  // constraining the end along x would stretch the bar
  estimator_ = std::make_unique<FingertipDriven>(body_, surface_, options_);
  estimator_->activate(*model_);
  contact_.loads[0].force.setZero();
  const double at = 0.45, up = 5e-3;
  static_cast<void>(run({at, 0.03, 0}, 200));
  static_cast<void>(run({at, 0.03, up}, 1000));
  const double inertia = std::pow(0.06, 4) / 12;
  const double beam = 3 * body_.material.young_modulus * inertia * up / std::pow(at, 3);
  // Shear adds 2 % of compliance, the indentation under the finger some more.
  const double force = estimator_->force(1).z();
  EXPECT_NEAR(force, beam, 0.06 * beam);
  // It rests, though friction is exhausted: between sticking and sliding it must not chatter.
  for (int i = 0; i < 100; ++i) {
    static_cast<void>(run({at, 0.03, up}, 10));
    EXPECT_NEAR(estimator_->force(1).z(), force, 2e-3 * force);
  }
}

TEST_F(FingertipDrivenTest, GoesBackToRestWhenTheFingerLetsGo) {
  static_cast<void>(run(kBelow, 200));
  static_cast<void>(run(kBelow + Vector3d(0, 0, 0.02), 1000));
  inputs_.contact_count = 0;
  double step = 0;  // m per tick
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Matrix3Xd before = model_->positions();
    static_cast<void>(run(kBelow, 1));
    step = std::max(step, (model_->positions() - before).colwise().norm().maxCoeff());
  }
  EXPECT_LT(step, 2 * options_.approach_speed * inputs_.dt) << "it does not jump back";
  EXPECT_EQ(estimator_->force(1).norm(), 0);
  EXPECT_LT((model_->positions() - body_.mesh.nodes).cwiseAbs().maxCoeff(), 1e-4);
}

TEST_F(FingertipDrivenTest, SlidesWhereFrictionDoesNotHold) {
  const Vector3d below(0.4, 0.03, 0);
  static_cast<void>(run(below, 200));
  static_cast<void>(run(below + Vector3d(0, 0, 0.005), 500));
  contact_.loads[0].force = Vector3d(0, 0, 0.05);  // a light contact bears 40 mN tangentially
  for (int i = 0; i < 60; ++i) static_cast<void>(run(below + Vector3d(-1e-3 * i, 0, 0.005), 20));
  const Vector3d force = estimator_->force(1);
  EXPECT_LE(std::hypot(force.x(), force.y()),
            options_.friction * std::max(0.05, force.z()) + 0.02 * force.norm());
  // It has not dragged the material along: 60 mm would have compressed the bar by an eighth.
  EXPECT_LT((node_at({0.5, 0.03, 0.03}) - Vector3d(0.5, 0.03, 0.03)).x(), 5e-3);
  EXPECT_GT((node_at({0.5, 0.03, 0.03}) - Vector3d(0.5, 0.03, 0.03)).x(), -5e-3);
}

TEST_F(FingertipDrivenTest, RefusesOptionsThatAreNotPositive) {
  options_.friction = 0;
  EXPECT_THROW(FingertipDriven(body_, surface_, options_), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::estimation
