#include <gtest/gtest.h>

#include "core/elasticity/static_solver.hpp"
#include "tests/unit/core/elasticity/stepping.hpp"

// From jelly (1e3 Pa) to plastic (1e9 Pa), from no load to a hundred times a reasonable one: the
// shape depends on load over stiffness, and, in dynamics, on h sqrt(E / rho) only.
namespace palpate::elasticity {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr double kReference = 1e5;  // Pa
constexpr double kStiffnessAndLoadStiffness[] = {1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9};
constexpr double kLength = 0.2;  // m
/// Fractions of a load that bends the bar by a fortieth of its length (linear elements: a third of
/// it).
constexpr double kShares[] = {0, 0.01, 1, 10, 100};

Body bar_of(mesh::ElementOrder order, double young_modulus) {
  return make_bar({kLength, 0.05, 0.05}, {4, 1, 1}, order, {young_modulus, 0.35, 300});
}

/// `share` of the reasonable load, downwards and sideways.
Matrix3Xd load_of(const Body& body, double share) {
  const double scale = share * body.material.young_modulus / kReference;
  return face_load(body.mesh, kLength, scale * Vector3d(0, 0.03, -0.1));
}

double distance(const Matrix3Xd& a, const Matrix3Xd& b) {
  return (a - b).colwise().norm().maxCoeff();
}

/// Static equilibrium under `share` of the load, to a residual suited to the stiffness.
Matrix3Xd equilibrium(const Body& body, double share) {
  StaticOptions options;
  options.tolerance = 1e-10 * body.material.young_modulus / kReference;
  const StaticSolution solution = solve_static(body, load_of(body, share), {}, options);
  EXPECT_TRUE(solution.converged);
  return solution.positions;
}

SolverOptions options_for(double young_modulus) {
  SolverOptions options;
  options.tolerance = 1e-7 * young_modulus / kReference;
  options.iterations = 4;
  return options;
}

/// Positions after each load of kShares in turn, `steps` of `dt` each; fails if a step gives
/// anything but a finite state within its iterations.
std::vector<Matrix3Xd> run(CorotationalModel& model, double dt, int steps) {
  const int most = 2 * options_for(1).iterations;  // twice: a step may restart from rest
  std::vector<Matrix3Xd> shapes;
  model.prepare();
  for (const double share : kShares) {
    model.loads() = load_of(model.body(), share);
    for (int i = 0; i < steps; ++i) {
      const StepReport report = model.step(dt);
      EXPECT_NE(report.status, StepStatus::kFailed) << "load x " << share << ", step " << i;
      EXPECT_LE(report.iterations, most);
      EXPECT_TRUE(std::isfinite(report.residual));
      if (!model.positions().allFinite()) {
        ADD_FAILURE() << "not finite under load x " << share << ", step " << i;
        return shapes;
      }
      refactor(model);
    }
    shapes.push_back(model.positions());
  }
  return shapes;
}

class EveryStiffness : public testing::TestWithParam<mesh::ElementOrder> {};
INSTANTIATE_TEST_SUITE_P(Order, EveryStiffness,
                         testing::Values(mesh::ElementOrder::kLinear,
                                         mesh::ElementOrder::kQuadratic));

TEST_P(EveryStiffness, BendsAlikeInStaticsUnderLoadsThatScaleWithIt) {
  CorotationalQuasistatic model(bar_of(GetParam(), kReference), options_for(kReference));
  const std::vector<Matrix3Xd> reference = run(model, kDt, 100);
  ASSERT_EQ(reference.size(), std::size(kShares));
  const Matrix3Xd& rest = model.body().mesh.nodes;
  EXPECT_LT(distance(reference[0], rest), 1e-12) << "nothing pulls";
  EXPECT_GT(distance(reference[2], rest), 0.005 * kLength);
  EXPECT_GT(distance(reference[4], rest), 0.5 * kLength) << "drawn out and turned into the load";
  // A hundredth of the load causes a hundredth of the deflection, to first order.
  EXPECT_LT(distance(100 * (reference[1] - rest), reference[2] - rest),
            0.05 * distance(reference[2], rest));
  for (std::size_t k = 0; k < std::size(kShares); ++k) {
    EXPECT_LT(distance(reference[k], equilibrium(model.body(), kShares[k])), 1e-5 * kLength)
        << "load x " << kShares[k];
  }
  for (const double young_modulus : kStiffnessAndLoadStiffness) {
    CorotationalQuasistatic other(bar_of(GetParam(), young_modulus), options_for(young_modulus));
    const std::vector<Matrix3Xd> shapes = run(other, kDt, 100);
    ASSERT_EQ(shapes.size(), reference.size());
    for (std::size_t k = 0; k < shapes.size(); ++k) {
      EXPECT_LT(distance(shapes[k], reference[k]), 1e-5 * kLength)
          << "E = " << young_modulus << ", load x " << kShares[k];
    }
  }
}

// Time scales with sqrt(rho / E): steps and damping in that unit, the same motion.
TEST_P(EveryStiffness, MovesAlikeInItsOwnTime) {
  const auto motion = [&](double young_modulus) {
    const double unit = std::sqrt(kReference / young_modulus);
    Body body = bar_of(GetParam(), young_modulus);
    body.damping = {5 / unit, 1e-3 * unit};
    SolverOptions options = options_for(young_modulus);
    options.time_step = kDt * unit;
    options.iterations = 20;
    CorotationalDynamic model(body, options);
    model.prepare();
    std::vector<Matrix3Xd> shapes;
    for (const double share : kShares) {
      model.loads() = load_of(body, share);
      for (int i = 0; i < 50; ++i) {
        EXPECT_NE(model.step(options.time_step).status, StepStatus::kFailed);
        refactor(model);
      }
      shapes.push_back(model.positions());
    }
    return shapes;
  };
  const std::vector<Matrix3Xd> reference = motion(kReference);
  EXPECT_GT(distance(reference[4], reference[0]), 0.5 * kLength);
  for (const double young_modulus : kStiffnessAndLoadStiffness) {
    const std::vector<Matrix3Xd> shapes = motion(young_modulus);
    for (std::size_t k = 0; k < shapes.size(); ++k) {
      EXPECT_LT(distance(shapes[k], reference[k]), 1e-4 * kLength)
          << "E = " << young_modulus << ", load x " << kShares[k];
    }
  }
}

// At the loop's own step, regardless of the body's time scale: every number must stay finite, and
// the final rest position equals the static one.
TEST_P(EveryStiffness, StaysWithinBoundsAtOneMillisecond) {
  for (const double young_modulus : kStiffnessAndLoadStiffness) {
    Body body = bar_of(GetParam(), young_modulus);
    body.damping = {2, 0};
    CorotationalDynamic model(body, options_for(young_modulus));
    const std::vector<Matrix3Xd> shapes = run(model, kDt, 100);
    ASSERT_EQ(shapes.size(), std::size(kShares)) << "E = " << young_modulus;
    for (const Matrix3Xd& x : shapes) EXPECT_LT(x.cwiseAbs().maxCoeff(), 20 * kLength);
    if (young_modulus < 1e6) continue;  // oscillates too slowly to be damped here
    model.loads() = load_of(body, 1);
    for (int i = 0; i < 3000; ++i) {
      model.step(kDt);
      refactor(model);
    }
    EXPECT_LT(distance(model.positions(), equilibrium(body, 1)), 1e-3 * kLength)
        << "E = " << young_modulus;
  }
}

}  // namespace
}  // namespace palpate::elasticity
