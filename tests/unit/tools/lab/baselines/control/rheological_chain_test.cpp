#include "tools/lab/baselines/control/rheological_chain.hpp"

#include <gtest/gtest.h>

#include "core/shape/point_features.hpp"
#include "tests/unit/tools/lab/baselines/control/held_bar_plant.hpp"
#include "tools/lab/baselines/control/chain_plan.hpp"
#include "tools/lab/baselines/control/open_loop.hpp"

namespace palpate::baselines {
namespace {

class Chain : public ::testing::Test {
 protected:
  math::Pose lifted(double height, double pitch = 0) const {
    math::Pose X = body_.grasps[0].X_OG_rest;
    X.translation().z() += height;
    X.linear() = math::exp_rotation({0, -pitch, 0}) * X.linear();
    return X;
  }
  double sag(const RheologicalChain& chain) const {
    const Eigen::Index middle = chain.masses().cols() / 2;
    return chain.masses().col(0).z() - chain.masses().col(middle).z();
  }
  elasticity::Body body_ = support::weightless_bar();
};

TEST_F(Chain, OfAStraightBarIsStraightAndGoesAlong) {
  RheologicalChain chain({}, body_, 0);
  const std::vector<Eigen::Vector3d> points{{0.1, 0, 0.03}, {0.3, 0.06, 0.06}, {0.5, 0, 0}};
  const Eigen::VectorXd rest = chain.points(points);
  for (int i = 0; i < 3; ++i)
    EXPECT_LT((rest.segment<3>(3 * i) - points[static_cast<std::size_t>(i)]).norm(), 1e-9);
  // The part held by the hand moves with it, including torsion.
  math::Pose X = lifted(0.04, 0.2);
  X.linear() = X.linear() * math::exp_rotation({0.5, 0, 0});
  ASSERT_TRUE(chain.step(X, 1));
  const math::Pose moved = X * body_.grasps[0].X_OG_rest.inverse();
  EXPECT_LT((chain.points(points).tail<3>() - moved * points[2]).norm(), 2e-3);
}

TEST_F(Chain, BendsAsABeamDoes) {
  // Both ends held, one lifted without rotation: w(x) = h (3 t^2 - 2 t^3) by Euler-Bernoulli.
  RheologicalChain::Options options;
  options.masses = 40;
  RheologicalChain chain(options, body_, 0);
  constexpr double kLift = 0.01;
  ASSERT_TRUE(chain.step(lifted(kLift), 1));
  const Eigen::Matrix3Xd& x = chain.masses();
  const double z0 = x.col(0).z();
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(x.cols() - 1);
    EXPECT_NEAR(x.col(i).z() - z0, kLift * t * t * (3 - 2 * t), 0.03 * kLift) << i;
  }
}

TEST_F(Chain, CreepsUnderItsWeightToTheStiffnessThatStays) {
  body_.gravity_O = {0, 0, -0.1};  // a small sag, in which links do not stretch
  RheologicalChain::Options options;
  options.relaxation = 0;
  const double elastic = sag(RheologicalChain(options, body_, 0));
  ASSERT_GT(elastic, 1e-6);
  // After infinite time at rest: half of the stiffness has relaxed, and the sag is twice as large.
  options.relaxation = 1;
  EXPECT_NEAR(sag(RheologicalChain(options, body_, 0)) / elastic, 2, 0.01);
  // In a motion of its ends, which a bar follows regardless of its stiffness.
  options.relaxation_time = 2;
  RheologicalChain chain(options, body_, 0);
  ASSERT_TRUE(chain.step(lifted(0.002), 1e-6));
  const double at_once = chain.masses()(2, chain.masses().cols() / 2);
  ASSERT_TRUE(chain.step(lifted(0.002), 1e6));
  EXPECT_NEAR(chain.masses()(2, chain.masses().cols() / 2), at_once, 1e-5);
}

TEST_F(Chain, RefusesWhatIsNoChain) {
  RheologicalChain::Options options;
  options.masses = 3;
  EXPECT_THROW(RheologicalChain(options, body_, 0), std::invalid_argument);
  EXPECT_THROW(RheologicalChain({}, body_, 1), std::invalid_argument);
  options = {};
  options.relaxation = -1;
  EXPECT_THROW(RheologicalChain(options, body_, 0), std::invalid_argument);
}

/// The paper's own task: a motion planned beforehand brings the points of a bar to a feasible
/// shape, without observation.
TEST_F(Chain, PlansAMotionThatShapesABar) {
  support::HeldBarPlant plant(body_);
  shape::PointsFeature feature(plant.body().mesh, {{{0.2, 0, 0.03}, {0.35, 0.06, 0.03}}});
  plant.place(lifted(0.05, 0.1));
  const Eigen::VectorXd target = plant.value(feature);
  plant.place(body_.grasps[0].X_OG_rest);
  const double first = (plant.value(feature) - target).norm();
  const InverseSolution plan = plan_with_chain(body_, 0, feature, target, {});
  ASSERT_TRUE(plan.converged);
  EXPECT_LT(plan.error, 1e-3);
  OpenLoop loop({}, plan);
  for (int i = 0; i < 160; ++i) {
    const Eigen::VectorXd value = plant.value(feature);
    loop.observe(support::seen(plant, value, 0.05));
    control::LawInputs inputs;
    inputs.dt = 0.05;
    math::Twist V;
    ASSERT_TRUE(loop.commands(inputs, V));
    plant.move(V, 0.05);
  }
  // The chain models neither shear nor thick ends: close, not exact.
  EXPECT_LT((plant.value(feature) - target).norm(), 0.25 * first);
}

}  // namespace
}  // namespace palpate::baselines
