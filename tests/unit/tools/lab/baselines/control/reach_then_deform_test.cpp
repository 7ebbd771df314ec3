#include "tools/lab/baselines/control/reach_then_deform.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/shape/point_features.hpp"
#include "rt/loop/allocation_counter.hpp"
#include "tests/unit/tools/lab/baselines/control/held_bar_plant.hpp"

namespace palpate::baselines {
namespace {

constexpr double kReachThenDeformDt = 0.02;

class Reaching : public ::testing::Test {
 protected:
  /// One tick: the law's velocity at this position of the hand, with the current feature.
  Eigen::Vector3d tick(ReachThenDeform& law, const math::Pose& X_OG, const Eigen::VectorXd& value,
                       const Eigen::VectorXd& target) {
    control::Experience now;
    now.dt = kReachThenDeformDt;
    now.value = &value;
    now.X_OG = X_OG;
    error_ = target - value;
    control::LawInputs inputs;
    inputs.dt = kReachThenDeformDt;
    inputs.error = &error_;
    math::Twist V;
    const loop::NoAllocationScope scope;
    law.observe(now);
    EXPECT_TRUE(law.commands(inputs, V));
    EXPECT_EQ(scope.count(), 0);
    EXPECT_EQ(V.angular.norm(), 0) << "a point has no rotation";
    return V.linear;
  }

  elasticity::Body body_ = support::weightless_bar();
  shape::PointsFeature feature_{body_.mesh, {{{0.2, 0, 0.03}}}};
  Eigen::VectorXd error_;
};

/// The paper's own task in one more dimension: a tip away from a spring of unknown stiffness
/// reaches it, presses, and brings a point of it to its target.
TEST_F(Reaching, TouchesAndThenBringsThePointToItsTarget) {
  ReachThenDeform::Options options;
  ReachThenDeform::Region region;
  region.tip_G = {0.05, 0, 0};
  region.place_O = {0.2, 0, -0.002};
  region.radius = 0.012;
  options.region = region;
  options.linear_speed = 0.1;
  options.dead_band = 1e-4;
  ReachThenDeform law(options, feature_);
  math::Pose X = math::Pose::Identity();
  X.translation() = region.place_O - region.tip_G - Eigen::Vector3d(0.03, -0.02, 0.08);
  const Eigen::VectorXd rest = Eigen::Vector3d(0.2, 0, 0.03);
  const Eigen::VectorXd target = rest + Eigen::VectorXd(Eigen::Vector3d(0, 0, 0.006));
  Eigen::VectorXd value = rest;
  double touched_after = -1, most_before = 0;
  for (int i = 0; i < 1000; ++i) {
    const double depth = (X * region.tip_G).z();  // the object's underside is at 0
    // The point moves by less than half of the tip's penetration.
    value = rest + Eigen::VectorXd(Eigen::Vector3d(0, 0, 0.4 * std::max(0.0, depth)));
    if (depth > 0 && touched_after < 0) touched_after = i * kReachThenDeformDt;
    if (depth <= 0)
      most_before =
          std::max(most_before, (law.jacobian().topRows<3>() - Eigen::Matrix3d::Identity()).norm());
    X.translation() += kReachThenDeformDt * tick(law, X, value, target);
  }
  EXPECT_GT(touched_after, 0.5);
  EXPECT_EQ(most_before, 0) << "nothing is learnt before anything moves";
  EXPECT_LT((value - target).norm(), 2e-4);
  // It has been learnt on the way that the point is less compliant than assumed.
  EXPECT_LT(law.jacobian()(2, 2), 0.8);
  EXPECT_GT(law.jacobian()(2, 2), 0.35);
  EXPECT_EQ(law.weight(), 1);

  law.reset();
  EXPECT_EQ(law.weight(), 0);
}

TEST_F(Reaching, OfWhatIsInTheHandDeformsAtOnce) {
  support::HeldBarPlant plant(body_);
  ReachThenDeform::Options options;
  options.gain = 2;
  options.dead_band = 1e-4;
  ReachThenDeform law(options, feature_);
  EXPECT_EQ(law.weight(), 1);
  const Eigen::VectorXd target =
      plant.value(feature_) + Eigen::VectorXd(Eigen::Vector3d(0, 0.01, 0.02));
  for (int i = 0; i < 400; ++i)
    plant.move({tick(law, plant.X_OG(), plant.value(feature_), target), Eigen::Vector3d::Zero()},
               kReachThenDeformDt);
  EXPECT_LT((plant.value(feature_) - target).norm(), 5e-4);
}

TEST_F(Reaching, RefusesWhatIsOutOfRange) {
  ReachThenDeform::Options options;
  options.gain = 0;
  EXPECT_THROW(ReachThenDeform(options, feature_), std::invalid_argument);
  options = {};
  options.update_gain = 2;
  EXPECT_THROW(ReachThenDeform(options, feature_), std::invalid_argument);
  options = {};
  options.region = ReachThenDeform::Region{};
  options.region->radius = 0;
  EXPECT_THROW(ReachThenDeform(options, feature_), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::baselines
