#include "tools/lab/baselines/control/open_loop.hpp"

#include <gtest/gtest.h>

#include "core/shape/point_features.hpp"
#include "tests/unit/tools/lab/baselines/control/held_bar_plant.hpp"

namespace palpate::baselines {
namespace {

class OpenLoops : public ::testing::Test {
 protected:
  OpenLoops() {
    X_goal_ = plant_.X_OG();
    X_goal_.translation() += Eigen::Vector3d(-0.01, 0.03, 0.05);
    X_goal_.linear() = math::exp_rotation({0.2, -0.3, 0.1});
    const math::Pose X_start = plant_.X_OG();
    plant_.place(X_goal_);
    target_ = plant_.value(feature_);
    wrench_ = plant_.wrench();
    plant_.place(X_start);
  }

  /// RMS distance of the points after this much time under the plan, m.
  double carry_out(OpenLoop& loop, int steps, double dt) {
    for (int i = 0; i < steps; ++i) {
      const Eigen::VectorXd value = plant_.value(feature_);
      loop.observe(support::seen(plant_, value, dt));
      control::LawInputs inputs;
      inputs.dt = dt;
      math::Twist V;
      EXPECT_TRUE(loop.commands(inputs, V));
      plant_.move(V, dt);
    }
    return (plant_.value(feature_) - target_).norm() / 2;
  }

  support::HeldBarPlant plant_{support::held_bar({6, 1, 1}, mesh::ElementOrder::kLinear)};
  shape::PointsFeature feature_{
      plant_.body().mesh,
      {{{0.2, 0, 0.03}, {0.35, 0, 0.03}, {0.35, 0.06, 0.03}, {0.2, 0.06, 0.03}}}};
  math::Pose X_goal_;
  Eigen::VectorXd target_;
  math::Wrench wrench_;
};

TEST_F(OpenLoops, FindThePoseAndTheWrenchOfAShapeThatCanBe) {
  const InverseSolution plan = solve_inverse(plant_.body(), 0, feature_, target_);
  EXPECT_TRUE(plan.converged);
  EXPECT_LT(plan.error, 1e-5);
  EXPECT_LT((plan.X_OG.translation() - X_goal_.translation()).norm(), 1e-3);
  EXPECT_LT((plan.F_G_O.vector() - wrench_.vector()).norm() / wrench_.vector().norm(), 0.01);
  EXPECT_THROW(solve_inverse(plant_.body(), 1, feature_, target_), std::invalid_argument);
  EXPECT_THROW(solve_inverse(plant_.body(), 0, feature_, target_.head(3)), std::invalid_argument);
}

TEST_F(OpenLoops, OfATargetBeyondReachGiveTheNearest) {
  Eigen::VectorXd torn = target_;
  torn[0] += 0.05;  // one of four corners pulled away
  const InverseSolution plan = solve_inverse(plant_.body(), 0, feature_, torn);
  EXPECT_TRUE(plan.converged);
  EXPECT_GT(plan.error, 0.02);
  EXPECT_LT(plan.error, 0.05);
}

TEST_F(OpenLoops, ByDisplacementGetThereOnTheSameObject) {
  OpenLoop loop({}, solve_inverse(plant_.body(), 0, feature_, target_));
  EXPECT_LT(carry_out(loop, 160, 0.05), 5e-4);
}

TEST_F(OpenLoops, ByForceGetThereOnTheSameObjectOnly) {
  OpenLoop::Options options;
  options.by_force = true;
  OpenLoop loop(options, solve_inverse(plant_.body(), 0, feature_, target_));
  EXPECT_LT(carry_out(loop, 400, 0.05), 2e-3);

  // With a modulus that is 30 % too high the same force is 30 % too large.
  elasticity::Body stiff = plant_.body();
  stiff.material.young_modulus *= 1.3;
  plant_.place(plant_.body().grasps[0].X_OG_rest);
  OpenLoop wrong(options, solve_inverse(stiff, 0, feature_, target_));
  EXPECT_GT(carry_out(wrong, 400, 0.05), 5e-3);
}

TEST_F(OpenLoops, RefuseWhatIsNoPlan) {
  EXPECT_THROW(OpenLoop({}, InverseSolution{}), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::baselines
