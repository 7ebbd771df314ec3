#include "sim/robot/reactive_grasp.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "tests/unit/sim/robot/arm.hpp"

namespace palpate::robot {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

/// Five fingers of three joints whose tips move 80, 42 and 20 mm per rad towards a spring that they
/// meet after `gap`; the joints follow their targets with a first-order lag.
struct SpringHand {
  static constexpr int kFingers = 5, kJoints = 15;
  std::vector<double> stiffness = std::vector<double>(kFingers, 300);  // N/m
  std::vector<double> gap = {0.010, 0.015, 0.020, 0.012, 0.018};       // m
  double lag = 0.5;  // fraction of the distance to the target left after a control step
  VectorXd q = VectorXd::Zero(kJoints);

  static std::vector<Finger> fingers() {
    std::vector<Finger> all;
    for (int f = 0; f < kFingers; ++f)
      all.push_back({{3 * f, 3 * f + 1, 3 * f + 2}, f == 4 ? 0.03 : 0.05});
    return all;
  }
  static JointLimits limits() {
    return {VectorXd::Constant(kJoints, -0.2), VectorXd::Constant(kJoints, 1.5),
            VectorXd::Constant(kJoints, 4), VectorXd::Constant(kJoints, 1)};
  }
  VectorXd force() const {
    VectorXd force(kFingers);
    for (int f = 0; f < kFingers; ++f)
      force(f) = std::max(0.0, stiffness[f] * (0.080 * q(3 * f) + 0.042 * q(3 * f + 1) +
                                               0.020 * q(3 * f + 2) - gap[f]));
    return force;
  }
  void follow(const VectorXd& target) { q = target + lag * (q - target); }
};

void reactive_grasp_run(SpringHand& hand, ReactiveGrasp& grasp, int steps) {
  for (int i = 0; i < steps; ++i) hand.follow(grasp.step(hand.q, hand.force()));
}

TEST(ReactiveGrasp, BringsEveryFingerIntoTheBandAndThere) {
  for (double k : {5.0, 50.0, 300.0, 3000.0}) {
    SpringHand hand;
    hand.stiffness.assign(5, k);
    ReactiveGrasp grasp(SpringHand::fingers(), SpringHand::limits());
    grasp.reset(hand.q);
    grasp.close();
    reactive_grasp_run(hand, grasp, 300);
    EXPECT_EQ(grasp.in_band(), 5) << k << " N/m";
    const VectorXd before = hand.force();
    EXPECT_GE(before.minCoeff(), 0.1) << k;
    EXPECT_LE(before.maxCoeff(), 1.0) << k;
    reactive_grasp_run(hand, grasp, 100);
    EXPECT_LT((hand.force() - before).cwiseAbs().maxCoeff(), 1e-6) << k;  // it rests
  }
}

TEST(ReactiveGrasp, FollowsAnObjectThatGivesWayOrSwells) {
  SpringHand hand;
  ReactiveGrasp grasp(SpringHand::fingers(), SpringHand::limits());
  grasp.reset(hand.q);
  grasp.close();
  reactive_grasp_run(hand, grasp, 200);
  hand.gap[1] += 0.010;  // contact lost
  EXPECT_EQ(hand.force()(1), 0);
  hand.gap[2] -= 0.010;  // 3 N more
  EXPECT_GT(hand.force()(2), 3);
  const VectorXd others = hand.q;
  reactive_grasp_run(hand, grasp, 300);
  EXPECT_EQ(grasp.in_band(), 5);
  EXPECT_LT((hand.q - others).segment<3>(9).norm(), 1e-6);  // its neighbour is unaffected
}

TEST(ReactiveGrasp, StepsAreTheThesisWhereNothingIsTouched) {
  SpringHand hand;
  ReactiveGrasp grasp(SpringHand::fingers(), SpringHand::limits());
  grasp.reset(hand.q);
  const VectorXd none = VectorXd::Zero(5);
  EXPECT_EQ(grasp.step(hand.q, none), hand.q);  // no command
  grasp.close();
  VectorXd target = grasp.step(hand.q, none);
  EXPECT_DOUBLE_EQ(target(0), 0.05);
  EXPECT_DOUBLE_EQ(target(14), 0.03);
  for (int i = 0; i < 4; ++i) target = grasp.step(hand.q, none);
  EXPECT_DOUBLE_EQ(target(0), 0.25);
  for (int i = 0; i < 40; ++i) target = grasp.step(hand.q, none);
  EXPECT_DOUBLE_EQ(target(0), GraspOptions().lead);  // a joint that is stuck is not left behind
  EXPECT_EQ(grasp.in_band(), 0);
}

TEST(ReactiveGrasp, OpensToTheLimitsAndBandsAreScaled) {
  SpringHand hand;
  ReactiveGrasp grasp(SpringHand::fingers(), SpringHand::limits());
  grasp.reset(hand.q);
  grasp.close({0.5, 3});
  reactive_grasp_run(hand, grasp, 300);
  EXPECT_GE(hand.force().minCoeff(), 0.5);
  EXPECT_LE(hand.force().maxCoeff(), 3);
  grasp.open();
  reactive_grasp_run(hand, grasp, 100);
  EXPECT_EQ(hand.force().maxCoeff(), 0);
  EXPECT_LT((hand.q - SpringHand::limits().lower).cwiseAbs().maxCoeff(), 1e-6);
  grasp.close();
  reactive_grasp_run(hand, grasp, 300);
  EXPECT_EQ(grasp.in_band(), 5);
}

TEST(ReactiveGrasp, FingerWithoutAReadingStays) {
  SpringHand hand;
  ReactiveGrasp grasp(SpringHand::fingers(), SpringHand::limits());
  grasp.reset(hand.q);
  grasp.close();
  for (int i = 0; i < 200; ++i) {
    VectorXd force = hand.force();
    force(3) = std::numeric_limits<double>::quiet_NaN();
    hand.follow(grasp.step(hand.q, force));
  }
  EXPECT_EQ(hand.q.segment<3>(9).norm(), 0);
  EXPECT_EQ(grasp.in_band(), 4);
}

TEST(ReactiveGrasp, RefusesWhatIsNoGrasp) {
  EXPECT_THROW(ReactiveGrasp({{{99}, 0.05}}, SpringHand::limits()), std::invalid_argument);
  EXPECT_THROW(ReactiveGrasp({{{0}, 0}}, SpringHand::limits()), std::invalid_argument);
  ReactiveGrasp grasp(SpringHand::fingers(), SpringHand::limits());
  EXPECT_THROW(grasp.close({1, 0.1}), std::invalid_argument);
  EXPECT_THROW(grasp.close({0, 1}), std::invalid_argument);
}

/// The real hand on a bar: fingertip spheres of 7 mm against two fixed walls of 400 N/m, 56 mm
/// apart in the hand (the bar of 60 mm, compressed by 2 mm per side at zero).
TEST(ReactiveGrasp, TheArmsHandGraspsABar) {
  Robot robot(load_model(kArmUrdf), RobotOptions());
  robot.set_joints(ready_pose());
  std::vector<Finger> fingers;
  const std::vector<std::string> tips = {"ff_tip", "mf_tip", "rf_tip", "lf_tip", "th_tip"};
  for (const std::string& tip : tips) {
    std::vector<int> chain = robot.hand_joints_to(tip);
    fingers.push_back({{chain.begin() + 1, chain.end()}, tip == "th_tip" ? 0.03 : 0.05});
  }
  robot.set_hand(robot.hand_limits().lower.cwiseMin(0));
  ReactiveGrasp grasp(fingers, robot.hand_limits());
  grasp.reset(robot.hand_positions());
  grasp.close();
  const double stiffness = 400, half = 0.028, radius = 0.007, damping = 2;
  VectorXd force = VectorXd::Zero(5);
  double highest = 0;
  for (int i = 0; i < 4000; ++i) {
    if (i % 10 == 0) robot.command_hand(grasp.step(robot.hand_positions(), force));
    const math::Pose X_WH = robot.link_pose("hand");
    for (int f = 0; f < 5; ++f) {
      const double side = f == 4 ? -1 : 1;
      const math::Pose X_HT = X_WH.inverse() * robot.link_pose(tips[f]);
      const Vector3d out = side * X_WH.linear().col(0);
      const double depth = half + radius - side * X_HT.translation().x();
      const double rate = out.dot(robot.link_twist(tips[f]).linear);
      force(f) = depth > 0 ? std::max(0.0, stiffness * depth - damping * rate) : 0;
      robot.set_link_load(tips[f], {force(f) * out, Vector3d::Zero()},
                          robot.link_pose(tips[f]).translation());
    }
    robot.step(1e-3);
    if (i > 3000) highest = std::max(highest, force.maxCoeff());
  }
  EXPECT_EQ(grasp.in_band(), 5);
  EXPECT_GE(force.minCoeff(), 0.1);
  EXPECT_LE(highest, 1.0);
  RecordProperty("lowest_force_N", std::to_string(force.minCoeff()));
  RecordProperty("highest_force_N", std::to_string(highest));
}

}  // namespace
}  // namespace palpate::robot
