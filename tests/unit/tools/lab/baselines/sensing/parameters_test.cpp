// Parameters estimated in addition to the shape, on the papers' own kind of task.
#include <gtest/gtest.h>

#include "tests/unit/tools/lab/baselines/seen_bar.hpp"
#include "tools/lab/baselines/sensing/euler_bernoulli_fit.hpp"
#include "tools/lab/baselines/sensing/probe_and_fit.hpp"
#include "tools/lab/baselines/sensing/shape_matching_fit.hpp"

namespace palpate::baselines {
namespace {

using Eigen::Vector3d;

/// A clamped bar without a hand.
elasticity::Body cantilever(double young_modulus, const std::array<int, 3>& cells) {
  elasticity::Body body = support::held_bar(cells, mesh::ElementOrder::kQuadratic);
  body.grasps.clear();
  body.material.young_modulus = young_modulus;
  return body;
}

/// Points on the upper side and on one other, with 1 mm of noise.
void look(const elasticity::DeformationModel& truth, math::Random& random,
          estimation::ObservationInput& out) {
  const mesh::PointLocator locator(truth.body().mesh);
  out.freshness = Freshness::kNew;
  out.points_O.resize(3, 160);
  for (int i = 0; i < 160; ++i) {
    const double s = random.uniform(0.01, 0.49), t = random.uniform(0.005, 0.055);
    const Vector3d rest = i % 2 == 0 ? Vector3d(s, t, 0.06) : Vector3d(s, 0, t);
    Vector3d p = locator.locate(rest).interpolate(truth.positions());
    for (double& x : p) x += 1e-3 * random.normal();
    out.points_O.col(i) = p;
  }
}

// Fugl et al. 2012: Young's modulus from the sag of an object under its own weight.
TEST(ParametersTest, SagDeterminesYoungsModulus) {
  for (const double young : {40e3, 60e3, 120e3}) {
    elasticity::CorotationalQuasistatic truth(cantilever(young, {12, 1, 1}));
    truth.prepare();
    for (int i = 0; i < 400; ++i) {
      if (elasticity::Refactorisation* job = truth.wanted_refactorisation()) {
        job->run();
        truth.install(*job);
      }
      truth.step(1e-3);
    }
    const elasticity::Body known = cantilever(70e3, {8, 1, 1});
    EulerBernoulliFit::Options options;
    options.log_young_deviation = 3;
    options.reach = 0.3;
    EulerBernoulliFit method(known, mesh::extract_surface(known.mesh), options);
    const auto model = support::carrier(known);
    model->prepare();
    method.activate(*model);
    math::Random random(3);
    estimation::EstimationInputs inputs;
    estimation::Estimate estimate;
    for (int i = 0; i < 60 * 20; ++i) {
      if (i % 20 == 0) look(truth, random, inputs.observation);
      static_cast<void>(method.update(inputs, *model, estimate));
      inputs.observation.freshness = Freshness::kOld;
    }
    std::printf("%.1f kPa: %.1f kPa\n", young * 1e-3, method.young_modulus() * 1e-3);
    EXPECT_NEAR(std::log(method.young_modulus() / young), 0, 0.15);
    EXPECT_NEAR(std::exp(estimate.log_young_modulus), method.young_modulus(), 1);
  }
}

// Frank et al. 2010: E and nu from a probe's force and the observed shape.
TEST(ParametersTest, ProbingDeterminesYoungsModulus) {
  for (const double factor : {0.6, 1.6}) {
    elasticity::Body truth = support::held_bar({8, 1, 1}, mesh::ElementOrder::kQuadratic);
    const elasticity::Body known = truth;
    truth.material.young_modulus *= factor;
    truth.material.poisson_ratio = 0.35;
    ProbeAndFit method(known, mesh::extract_surface(known.mesh), {});
    support::Watcher watcher(truth, 1e-3,
                             std::make_unique<elasticity::CorotationalQuasistatic>(known), method);
    EXPECT_EQ(watcher.run(6, 3, {0, 0.03, -0.06}, {0.3, 0, 0}), 0);
    EXPECT_TRUE(method.is_done());
    std::printf("E x %.1f: found %.3f, nu %.3f (+- %.3f)\n", factor, std::exp(method.found()[0]),
                method.found()[1], method.deviation()[1]);
    EXPECT_NEAR(std::exp(method.found()[0]), factor, 0.05 * factor);
    EXPECT_NEAR(method.found()[1], 0.35, 0.06);
    EXPECT_LT(watcher.error().first, 5e-4);
    EXPECT_LT((watcher.estimate.reaction[0].force - watcher.world.model().reaction(0).force).norm(),
              0.02);
  }
}

// Gueler et al. 2017: a deformability for every object, which distinguishes it; the stiffer
// prediction must not win if the object shears and stretches considerably.
TEST(ParametersTest, DeformabilityIsThatOfTheNearestPrediction) {
  const elasticity::Body body = support::held_bar({8, 1, 1}, mesh::ElementOrder::kQuadratic);
  const mesh::Surface surface = mesh::extract_surface(body.mesh);
  ShapeMatchingFit::Options alone;
  alone.candidates = 1;  // 0.5
  ShapeMatchingFit fixed(body, surface, alone), fitted(body, surface, {});
  const Vector3d way(0.05, 0.02, -0.05), turn(0.5, 0.3, 0);
  support::Watcher a(body, 3e-4, support::carrier(body), fixed);
  support::Watcher b(body, 3e-4, support::carrier(body), fitted);
  a.run(3, 1.5, way, turn);
  b.run(3, 1.5, way, turn);
  std::printf("beta %.2f: %.2f mm, 0.5: %.2f mm\n", fitted.deformability(), b.error().first * 1e3,
              a.error().first * 1e3);
  EXPECT_GE(fitted.deformability(), 0);
  EXPECT_LT(b.error().first, 1.02 * a.error().first);
}

}  // namespace
}  // namespace palpate::baselines
