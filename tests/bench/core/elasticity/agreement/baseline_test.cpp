#include <gtest/gtest.h>

#include <tuple>

#include "tests/bench/core/elasticity/baseline_model.hpp"
#include "tests/bench/core/elasticity/scenario.hpp"

namespace palpate::bench {
namespace {

using Solver = BaselineModel::Solver;

/// A ratio between two programs is meaningful only if both compute the same.
class BaselineAgrees : public testing::TestWithParam<std::tuple<mesh::ElementOrder, Solver>> {};

TEST_P(BaselineAgrees, WithTheConvergedModelAlongMotionL) {
  const auto [order, solver] = GetParam();
  const Scenario scenario({order, {4, 2, 2}}, Motion::kLarge);
  elasticity::SolverOptions options;
  options.iterations = 20;
  options.tolerance = 1e-8;
  options.accuracy = 0;
  const auto model = make_model(scenario.body(), Mechanics::kDynamic, options);
  BaselineModel baseline(scenario.body(), solver, true);
  double amplitude = 0, difference = 0;
  for (int k = 1; k <= 300; ++k) {
    scenario.apply(1e-3 * k, *model);
    ASSERT_NE(model->step(1e-3).status, elasticity::StepStatus::kFailed);
    support::refactor(*model);
    ASSERT_TRUE(baseline.step(1e-3, scenario.clamp_pose(1e-3 * k), model->loads()));
    const auto distance = [&](const Eigen::Matrix3Xd& x) {
      return (model->positions() - x).colwise().norm().maxCoeff();
    };
    amplitude = std::max(amplitude, distance(scenario.body().mesh.nodes));
    difference = std::max(difference, distance(baseline.positions()));
  }
  EXPECT_GT(amplitude, 0.1);  // it did move
  // Accumulated effect of single Newton steps and a linear solver's tolerance in 300 steps.
  EXPECT_LT(difference, (solver == Solver::kCholmod ? 1e-4 : 1e-3) * amplitude);
}

std::string name_of(const testing::TestParamInfo<BaselineAgrees::ParamType>& test) {
  const auto [order, solver] = test.param;
  return std::string(order == mesh::ElementOrder::kLinear ? "Linear" : "Quadratic") +
         (solver == Solver::kCholmod ? "Cholmod" : "JacobiPcg");
}

INSTANTIATE_TEST_SUITE_P(Baselines, BaselineAgrees,
                         testing::Combine(testing::Values(mesh::ElementOrder::kLinear,
                                                          mesh::ElementOrder::kQuadratic),
                                          testing::Values(Solver::kCholmod, Solver::kJacobiPcg)),
                         name_of);

TEST(Inverted, CountsEveryPointOfAMirroredBarAndNoneAtRest) {
  const Scenario scenario({mesh::ElementOrder::kQuadratic, {4, 2, 2}}, Motion::kStep);
  const BaselineSystem system(scenario.body());
  Eigen::Matrix3Xd x = scenario.body().mesh.nodes;
  EXPECT_EQ(system.inverted(x), 0);
  x.row(0) *= -1;
  EXPECT_EQ(system.inverted(x), 4 * scenario.body().mesh.element_count());
}

}  // namespace
}  // namespace palpate::bench
