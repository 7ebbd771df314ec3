#include "sim/robot/robot.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "tests/unit/sim/robot/arm.hpp"

namespace palpate::robot {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kRobotDt = 1e-3;
constexpr double kHandMass = 4.8;
const Vector3d kHandCentre(0.0015, -0.00065, 0.1137);  // in S
constexpr double kRobotGravity = 9.81;

Robot make_arm() { return Robot(load_model(kArmUrdf), RobotOptions()); }

void robot_run(Robot& robot, double seconds) {
  for (int i = 0, n = std::lround(seconds / kRobotDt); i < n; ++i) robot.step(kRobotDt);
}

/// The LWR's forward kinematics, derived by hand.
math::Pose forward(const VectorXd& q) {
  const double up[] = {0.3105, 0, 0.4, 0, 0.39, 0, 0.078};
  const Vector3d axis[] = {Vector3d::UnitZ(), -Vector3d::UnitY(), Vector3d::UnitZ(),
                           Vector3d::UnitY(), Vector3d::UnitZ(),  -Vector3d::UnitY(),
                           Vector3d::UnitZ()};
  math::Pose X = math::Pose::Identity();
  for (int i = 0; i < 7; ++i) X = X * AngleAxisd(q(i), axis[i]) * Eigen::Translation3d(0, 0, up[i]);
  return X;
}

TEST(Robot, ForwardKinematicsAreThoseOfTheArm) {
  Robot robot = make_arm();
  for (const VectorXd& q : postures()) {
    robot.set_joints(q);
    EXPECT_TRUE(robot.flange_pose().isApprox(forward(q), 1e-9));
    EXPECT_TRUE(robot.link_pose("sensor").isApprox(
        robot.flange_pose() * Eigen::Translation3d(0, 0, 0.04), 1e-9));
    EXPECT_NEAR((robot.link_pose("grasp").translation() - robot.flange_pose().translation()).norm(),
                0.3, 1e-9);
  }
}

TEST(Robot, JacobianIsTheDerivativeOfThePose) {
  Robot robot = make_arm();
  const double h = 1e-6;
  for (const VectorXd& q : postures()) {
    robot.set_joints(q);
    const auto jacobian = robot.flange_jacobian();
    const math::Pose X = robot.flange_pose();
    for (int i = 0; i < 7; ++i) {
      VectorXd ahead = q;
      ahead(i) += h;
      robot.set_joints(ahead);
      const math::Pose Y = robot.flange_pose();
      math::Vector6d column;
      column << (Y.translation() - X.translation()) / h,
          math::log_rotation(Y.linear() * X.linear().transpose()) / h;
      EXPECT_LT((column - jacobian.col(i)).norm(), 2e-6);
    }
  }
}

TEST(Robot, SensorCarriesTheHandsWeightAtRest) {
  Robot robot = make_arm();
  for (const VectorXd& q : postures()) {
    robot.set_joints(q);
    robot_run(robot, 0.05);
    const Matrix3d R_SW = robot.link_pose("sensor").linear().transpose();
    const Vector3d force = R_SW * Vector3d(0, 0, kHandMass * kRobotGravity);  // upward, on the hand
    const math::Wrench F = robot.sensor_wrench();
    EXPECT_LT((F.force - force).norm(), 1e-6);
    EXPECT_LT((F.torque - kHandCentre.cross(force)).norm(), 1e-5);
    const ImuReading imu = robot.imu();
    EXPECT_NEAR(imu.acceleration.norm(), kRobotGravity, 1e-6);
    const Vector3d up = robot.link_pose("imu").linear() * imu.acceleration;
    EXPECT_NEAR(up.z(), kRobotGravity, 1e-6);
  }
}

TEST(Robot, SensorForceFollowsTheMotionOfTheHandsCentreOfMass) {
  Robot robot = make_arm();
  robot.set_joints(ready_pose());
  const auto centre = [&robot] { return Vector3d(robot.link_pose("sensor") * kHandCentre); };
  Vector3d before = centre(), now = before;
  double largest = 0;
  for (int i = 0; i < 1500; ++i) {
    const double t = i * kRobotDt;
    robot.command_twist(
        {Vector3d(0.2 * std::sin(4 * t), 0.3 * std::cos(5 * t), 0.2 * std::sin(3 * t)),
         Vector3d(std::sin(6 * t), std::sin(5 * t), 1.5 * std::sin(7 * t))});
    robot.step(kRobotDt);
    const Vector3d next = centre();
    if (i > 10) {
      // The second difference is the acceleration one tick ago; a tick changes it little.
      const Vector3d a = (next - 2 * now + before) / (kRobotDt * kRobotDt);
      const Vector3d force_W = kHandMass * (a + Vector3d(0, 0, kRobotGravity));
      const Vector3d F_W = robot.link_pose("sensor").linear() * robot.sensor_wrench().force;
      largest = std::max(largest, (F_W - Vector3d(0, 0, kHandMass * kRobotGravity)).norm());
      EXPECT_LT((F_W - force_W).norm(), 0.25) << "at " << t << " s";
    }
    before = now;
    now = next;
  }
  EXPECT_GT(largest, 3);  // the motion did load the sensor
}

TEST(Robot, AChangedLoadIsFeltInMotion) {
  // What the sensor feels beyond the scaled hand is the change of the load's momenta, whose
  // differences are taken in W.
  RobotOptions changed;
  changed.hand_mass_factor = 0.6;
  changed.load.mass = 1.7;
  changed.load.center_of_mass = {0.03, -0.02, 0.09};
  changed.load.inertia << 0.004, 0.0005, -0.0003, 0.003, 0.0004, 0.002;
  Matrix3d about_center;
  about_center << 0.004, 0.0005, -0.0003, 0.0005, 0.003, 0.0004, -0.0003, 0.0004, 0.002;
  Robot plain = make_arm(), robot(load_model(kArmUrdf), changed);
  plain.set_joints(ready_pose());
  robot.set_joints(ready_pose());
  struct Momenta {
    Vector3d place, spin;
  };
  const auto momenta = [&] {
    const math::Pose X_WS = robot.link_pose("sensor");
    const Vector3d spin = X_WS.linear() * about_center * X_WS.linear().transpose() *
                          robot.link_twist("sensor").angular;
    return Momenta{X_WS * changed.load.center_of_mass, spin};
  };
  Momenta before = momenta(), now = before;
  double largest = 0;
  for (int i = 0; i < 1500; ++i) {
    const double t = i * kRobotDt;
    const math::Twist twist{
        Vector3d(0.2 * std::sin(4 * t), 0.3 * std::cos(5 * t), 0.2 * std::sin(3 * t)),
        Vector3d(std::sin(6 * t), std::sin(5 * t), 1.5 * std::sin(7 * t))};
    for (Robot* each : {&plain, &robot}) {
      each->command_twist(twist);
      each->step(kRobotDt);
    }
    const Momenta next = momenta();
    if (i > 10) {
      const math::Pose X_WS = robot.link_pose("sensor");
      const math::Wrench of_hand = plain.sensor_wrench(), felt = robot.sensor_wrench();
      const Vector3d a = (next.place - 2 * now.place + before.place) / (kRobotDt * kRobotDt);
      const Vector3d force = changed.load.mass * (a + Vector3d(0, 0, kRobotGravity));
      const Vector3d torque =
          (next.spin - now.spin) / kRobotDt + (next.place - X_WS.translation()).cross(force);
      const Vector3d added_force = felt.force - changed.hand_mass_factor * of_hand.force;
      const Vector3d added_torque = felt.torque - changed.hand_mass_factor * of_hand.torque;
      EXPECT_LT((X_WS.linear() * added_force - force).norm(), 0.1) << "at " << t << " s";
      EXPECT_LT((X_WS.linear() * added_torque - torque).norm(), 0.012) << "at " << t << " s";
      largest = std::max(largest, ((next.spin - now.spin) / kRobotDt).norm());
    }
    before = now;
    now = next;
  }
  EXPECT_GT(largest, 0.03);  // N m: the inertia matters
}

TEST(Robot, SensorTorqueAboutTheLastAxisIsThatJointsTorque) {
  // Joint 7 drives link 7 (a thin cylinder on its axis) and everything carried by the sensor.
  Robot robot = make_arm();
  robot.set_joints(ready_pose());
  const double own_inertia = 0.11 * 0.04 * 0.04 / 2;
  double largest = 0;
  VectorXd rate = VectorXd::Zero(7);
  double last_speed = 0;
  for (int i = 0; i < 1000; ++i) {
    const double t = i * kRobotDt;
    rate << 0.3 * std::sin(3 * t), 0.3 * std::sin(4 * t), 0, 0.2 * std::sin(5 * t), 0,
        0.4 * std::sin(4 * t), 1.2 * std::sin(8 * t);
    robot.command_joints(rate);
    robot.set_hand_load({Vector3d(1, 2, 0.5), Vector3d(0.1, 0.2, -0.1)},
                        robot.link_pose("grasp").translation());
    robot.step(kRobotDt);
    const double speed = robot.joint_velocities()(6);
    const double own = own_inertia * (speed - last_speed) / kRobotDt;
    last_speed = speed;
    if (i < 10) continue;
    EXPECT_NEAR(robot.sensor_wrench().torque.z() + own, robot.joint_torques()(6), 0.01);
    largest = std::max(largest, std::abs(robot.joint_torques()(6)));
  }
  EXPECT_GT(largest, 0.15);  // N m, ten times the tolerance
}

TEST(Robot, ObjectsLoadReachesTheSensorAndTheArmHolds) {
  Robot robot = make_arm();
  robot.set_joints(ready_pose());
  robot_run(robot, 0.05);
  const math::Wrench free = robot.sensor_wrench();
  const Vector3d p_G = robot.link_pose("grasp").translation();
  const math::Wrench load{Vector3d(2, -5, -8), Vector3d(0.3, 0.2, -0.4)};
  robot.set_hand_load(load, p_G);
  robot_run(robot, 1.0);
  const math::Pose X_WS = robot.link_pose("sensor");
  const math::Wrench felt = robot.sensor_wrench();
  const math::Wrench expected = math::move_reference(load, X_WS.translation() - p_G);
  EXPECT_LT((X_WS.linear() * (felt.force - free.force) + expected.force).norm(), 1e-6);
  EXPECT_LT((X_WS.linear() * (felt.torque - free.torque) + expected.torque).norm(), 1e-6);
  EXPECT_LT((robot.link_pose("grasp").translation() - p_G).norm(), 1e-5);
}

TEST(Robot, FollowsACartesianTwist) {
  Robot robot = make_arm();
  robot.set_joints(ready_pose());
  const math::Pose start = robot.flange_pose();
  const math::Twist twist{Vector3d(-0.05, 0.08, 0.06), Vector3d(0.2, -0.1, 0.3)};
  for (int i = 0; i < 1000; ++i) {
    robot.command_twist(twist);
    robot.step(kRobotDt);
    if (i < 300) continue;
    EXPECT_LT((robot.flange_twist().linear - twist.linear).norm(), 1e-3);
    EXPECT_LT((robot.flange_twist().angular - twist.angular).norm(), 2e-3);
  }
  // One second at constant twist, less the short start at the acceleration limit.
  const Vector3d moved = robot.flange_pose().translation() - start.translation();
  EXPECT_LT((moved - twist.linear).norm(), 2e-3);
  const Vector3d turned =
      math::log_rotation(robot.flange_pose().linear() * start.linear().transpose());
  EXPECT_LT((turned - twist.angular).norm(), 8e-3);
}

TEST(Robot, PullsBackToItsPostureWithoutMovingTheHand) {
  Robot robot = make_arm();
  robot.set_joints(ready_pose());
  VectorXd rate = VectorXd::Zero(7);
  rate(2) = 0.5;
  for (int i = 0; i < 600; ++i) {
    robot.command_joints(rate);
    robot.step(kRobotDt);
  }
  const math::Pose held = robot.flange_pose();
  const double away = (robot.joint_positions() - ready_pose()).norm();
  for (int i = 0; i < 3000; ++i) {
    robot.command_twist(math::Twist());
    robot.step(kRobotDt);
  }
  EXPECT_LT((robot.joint_positions() - ready_pose()).norm(), 0.95 * away);
  // Minus the distance that the arm needs to stop.
  EXPECT_LT((robot.flange_pose().translation() - held.translation()).norm(), 0.02);
  EXPECT_LT(robot.flange_twist().linear.norm(), 1e-4);
}

TEST(Robot, StopsWhenCommandsAreStale) {
  Robot robot = make_arm();
  robot.set_joints(ready_pose());
  const math::Twist twist{Vector3d(0, 0.1, 0.05), Vector3d::Zero()};
  for (int i = 0; i < 300; ++i) {
    robot.command_twist(twist);
    robot.step(kRobotDt);
  }
  robot_run(robot, 0.09);  // a short gap is bridged
  EXPECT_NEAR(robot.flange_twist().linear.norm(), twist.linear.norm(), 2e-3);
  robot_run(robot, 0.25);
  EXPECT_LT(robot.flange_twist().linear.norm(), 1e-4);
  const math::Pose rest = robot.flange_pose();
  robot_run(robot, 0.5);
  EXPECT_LT((robot.flange_pose().translation() - rest.translation()).norm(), 1e-6);
}

TEST(Robot, KeepsItsJointsWithinPositionSpeedAndTorqueLimits) {
  for (double sign : {-1.0, 1.0})
    for (int joint = 0; joint < 7; ++joint) {
      Robot robot = make_arm();
      robot.set_joints(ready_pose());
      VectorXd rate = VectorXd::Zero(7);
      rate(joint) = sign * 10;  // beyond every speed limit
      for (int i = 0; i < 3500; ++i) {
        robot.command_joints(rate);
        robot.step(kRobotDt);
        const VectorXd q = robot.joint_positions();
        ASSERT_TRUE((q.array() > robot.limits().lower.array()).all() &&
                    (q.array() < robot.limits().upper.array()).all())
            << "joint " << joint << " at " << q.transpose();
        ASSERT_TRUE(
            (robot.joint_velocities().cwiseAbs().array() <= 1.02 * robot.limits().velocity.array())
                .all());
        ASSERT_TRUE(
            (robot.joint_torques().cwiseAbs().array() <= robot.limits().torque.array()).all());
      }
      const double end = sign > 0 ? robot.limits().upper(joint) : robot.limits().lower(joint);
      EXPECT_NEAR(robot.joint_positions()(joint), end, 0.03) << "joint " << joint;
      EXPECT_LT(std::abs(robot.joint_velocities()(joint)), 0.01);
    }
}

TEST(Robot, RefusesJointsBeyondTheirLimits) {
  Robot robot = make_arm();
  EXPECT_THROW(robot.set_joints(joints({0, 2.2, 0, 0, 0, 0, 0})), std::invalid_argument);
  EXPECT_THROW(robot.set_joints(joints({0, 0, 0})), std::invalid_argument);
  EXPECT_THROW(robot.link_pose("nowhere"), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::robot
