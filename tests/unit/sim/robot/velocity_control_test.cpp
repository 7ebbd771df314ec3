#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "tests/unit/sim/robot/arm.hpp"

// Guarantees of the arm's Cartesian velocity control for arbitrary commands.
namespace palpate::robot {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kControlDt = 1e-3;

Robot make_arm_with(const RobotOptions& options = {}) {
  Robot robot(load_model(kArmUrdf), options);
  robot.set_joints(ready_pose());
  return robot;
}

/// Smallest distance of any joint from its limits, rad.
double room(const Robot& robot) {
  const VectorXd q = robot.joint_positions();
  return std::min((robot.limits().upper - q).minCoeff(), (q - robot.limits().lower).minCoeff());
}

TEST(VelocityControl, LimitsHoldUnderAdversarialCommands) {
  double closest = 1, fastest = 0, farthest = 0;
  for (unsigned seed = 1; seed <= 3; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(-1, 1);
    Robot robot = make_arm_with();
    const VectorXd centre = 0.5 * (robot.limits().upper + robot.limits().lower);
    const VectorXd half = 0.5 * (robot.limits().upper - robot.limits().lower);
    int kind = 0, left = 0;
    VectorXd rate = VectorXd::Zero(7);
    math::Vector6d twist = math::Vector6d::Zero();
    for (int i = 0; i < 10000; ++i) {
      if (left-- <= 0) {
        kind = static_cast<int>(random() % 5);
        left = static_cast<int>(random() % 600);
        for (double& r : rate) r = 20 * unit(random);
        for (double& v : twist) v = 10 * unit(random);
      }
      if (kind == 0) robot.command_joints(rate);
      if (kind == 1) robot.command_twist(math::Twist::from(twist));
      if (kind == 2) robot.command_joints((random() % 2 ? 20 : -20) * VectorXd::Ones(7));  // bang
      if (kind == 3) robot.command_twist(math::Twist::from((i / 7 % 2 ? 10 : -10) * twist));
      // kind 4: silence
      robot.step(kControlDt);
      closest = std::min(closest, room(robot));
      const double speed =
          (robot.joint_velocities().cwiseAbs().array() / robot.limits().velocity.array())
              .maxCoeff();
      fastest = std::max(fastest, speed);
      ASSERT_TRUE(
          (robot.joint_torques().cwiseAbs().array() <= robot.limits().torque.array()).all());
      ASSERT_GT(closest, 0) << "seed " << seed << " at " << i << " ms";
      ASSERT_LT(speed, 1.05) << "seed " << seed << " at " << i << " ms";
      const VectorXd share = (robot.joint_positions() - centre).cwiseQuotient(half).cwiseAbs();
      farthest = std::max(farthest, share.maxCoeff());
    }
  }
  EXPECT_GT(farthest, 0.98);  // the limits were indeed approached
  RecordProperty("closest_to_an_end_rad", std::to_string(closest));
  RecordProperty("fastest_share_of_limit", std::to_string(fastest));
}

TEST(VelocityControl, TorqueLimitsSaturateVisibly) {
  Robot robot = make_arm_with();
  for (int i = 0; i < 200; ++i) robot.step(kControlDt);
  EXPECT_FALSE(robot.torque_limited());
  EXPECT_EQ(robot.torque_limited_steps(), 0);
  // At G, 0.38 m from joint 6 and its 30 N m: 20 N in addition to the hand's weight are held, 200 N
  // are not.
  const Vector3d p_G = robot.link_pose("grasp").translation();
  robot.set_hand_load({Vector3d(0, 0, -20), Vector3d::Zero()}, p_G);
  for (int i = 0; i < 100; ++i) robot.step(kControlDt);
  EXPECT_EQ(robot.torque_limited_steps(), 0);
  robot.set_hand_load({Vector3d(0, 0, -200), Vector3d::Zero()}, p_G);
  int limited = 0;
  for (int i = 0; i < 30; ++i) {
    robot.step(kControlDt);
    limited += robot.torque_limited() ? 1 : 0;
    EXPECT_TRUE((robot.joint_torques().cwiseAbs().array() <= robot.limits().torque.array()).all());
    const bool at_limit =
        (robot.joint_torques().cwiseAbs().array() >= robot.limits().torque.array()).any();
    EXPECT_EQ(at_limit, robot.torque_limited());
  }
  EXPECT_EQ(limited, 30);
  EXPECT_EQ(robot.torque_limited_steps(), limited);
  // Once the load is removed the arm comes to rest near its displaced position, without wind-up.
  robot.set_hand_load(math::Wrench(), p_G);
  for (int i = 0; i < 1500; ++i) robot.step(kControlDt);
  EXPECT_FALSE(robot.torque_limited());
  EXPECT_LT(robot.joint_velocities().norm(), 1e-3);
}

TEST(VelocityControl, StaleCommandsStopWithinTheAccelerationLimit) {
  RobotOptions options;
  options.follower.acceleration = 4;
  Robot robot = make_arm_with(options);
  const double limit = options.follower.acceleration;
  VectorXd rate(7);
  rate << 0.8, -0.5, 0.6, 0.4, 1.0, -0.7, 0.9;
  for (int i = 0; i < 500; ++i) {
    robot.command_joints(rate);
    robot.step(kControlDt);
  }
  EXPECT_LT((robot.joint_velocities() - rate).cwiseAbs().maxCoeff(), 1e-3);
  VectorXd before = robot.joint_velocities();
  double hardest = 0;
  int stopped_after = 0;
  for (int i = 1; i <= 600; ++i) {
    robot.step(kControlDt);  // silence
    const VectorXd now = robot.joint_velocities();
    hardest = std::max(hardest, (now - before).cwiseAbs().maxCoeff() / kControlDt);
    before = now;
    if (now.cwiseAbs().maxCoeff() > 1e-3) stopped_after = i;
  }
  EXPECT_LT(hardest, 1.01 * limit);
  EXPECT_GT(hardest, 0.9 * limit);
  // The time-out, the fastest joint's braking time, and the settling of a controller of 15 Hz.
  const double expected = options.follower.command_time_out + rate.maxCoeff() / limit;
  EXPECT_GT(kControlDt * stopped_after, expected - 0.01);
  EXPECT_LT(kControlDt * stopped_after, expected + 0.05);
}

struct Tracking {
  double linear_rms = 0, angular_rms = 0, linear_most = 0, angular_most = 0;
};

/// Error of the flange's twist on a Lissajous motion about the ready pose.
Tracking track(double frequency) {
  Robot robot = make_arm_with();
  Tracking e;
  const int first = 500, last = 8000;
  for (int i = 0; i < last; ++i) {
    const double w = 2 * M_PI * frequency, t = kControlDt * (i + 1), ramp = std::min(1.0, t / 0.3);
    const math::Twist V{
        ramp * 0.1 * Vector3d(std::cos(w * t), std::sin(2 * w * t), std::cos(3 * w * t)),
        ramp * 0.3 * Vector3d(std::sin(w * t), std::cos(2 * w * t), std::sin(w * t))};
    robot.command_twist(V);
    robot.step(kControlDt);
    if (i < first) continue;
    const double linear = (robot.flange_twist().linear - V.linear).norm();
    const double angular = (robot.flange_twist().angular - V.angular).norm();
    e.linear_rms += linear * linear / (last - first);
    e.angular_rms += angular * angular / (last - first);
    e.linear_most = std::max(e.linear_most, linear);
    e.angular_most = std::max(e.angular_most, angular);
  }
  e.linear_rms = std::sqrt(e.linear_rms);
  e.angular_rms = std::sqrt(e.angular_rms);
  EXPECT_EQ(robot.torque_limited_steps(), 0);
  return e;
}

TEST(VelocityControl, TracksACommandedTwist) {
  const Tracking e = track(0.5);
  EXPECT_LT(e.linear_rms, 0.5e-3);   // m/s, of 0.17 m/s
  EXPECT_LT(e.angular_rms, 1.5e-3);  // rad/s, of 0.5 rad/s
  RecordProperty("linear_rms_mm_s", std::to_string(1e3 * e.linear_rms));
  RecordProperty("linear_most_mm_s", std::to_string(1e3 * e.linear_most));
  RecordProperty("angular_rms_mrad_s", std::to_string(1e3 * e.angular_rms));
  RecordProperty("angular_most_mrad_s", std::to_string(1e3 * e.angular_most));
}

/// Joint positions after some circles of the hand, whose pose follows the circle, so that only the
/// null space can drift.
std::vector<VectorXd> circle(double posture_gain, int circles) {
  RobotOptions options;
  options.follower.posture_gain = posture_gain;
  Robot robot = make_arm_with(options);
  const math::Pose start = robot.flange_pose();
  const double radius = 0.05, period = 1.6, w = 2 * M_PI / period;
  const int steps = static_cast<int>(std::lround(period / kControlDt));
  std::vector<VectorXd> after;
  for (int i = 0; i < circles * steps; ++i) {
    const double t = kControlDt * i;
    const math::Pose X = robot.flange_pose();
    const Vector3d target =
        start.translation() + radius * Vector3d(0, std::sin(w * t), 1 - std::cos(w * t));
    const Vector3d speed = radius * w * Vector3d(0, std::cos(w * t), std::sin(w * t));
    robot.command_twist({speed + 5 * (target - X.translation()),
                         5 * math::log_rotation(start.linear() * X.linear().transpose())});
    robot.step(kControlDt);
    if ((i + 1) % steps == 0) after.push_back(robot.joint_positions());
  }
  EXPECT_LT((robot.flange_pose().translation() - start.translation()).norm(), 2e-3);
  return after;
}

TEST(VelocityControl, NullSpaceDriftIsBounded) {
  const int n = 10;
  const auto held = circle(1, n), free = circle(0, n);
  const double held_drift = (held.back() - held[n / 2 - 1]).norm();
  const double free_drift = (free.back() - free[n / 2 - 1]).norm();
  // Without a posture the pseudo-inverse does not bring the joints back (Klein and Huang 1983).
  EXPECT_GT(free_drift, 0.2);
  EXPECT_LT(held_drift, 2e-3);
  EXPECT_LT((held.back() - ready_pose()).norm(), 0.3);
  RecordProperty("free_drift_rad", std::to_string(free_drift));
  RecordProperty("held_drift_rad", std::to_string(held_drift));
  RecordProperty("held_from_posture_rad", std::to_string((held.back() - ready_pose()).norm()));
}

}  // namespace
}  // namespace palpate::robot
