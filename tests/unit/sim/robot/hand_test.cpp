#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "tests/unit/sim/robot/arm.hpp"

namespace palpate::robot {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kHandDt = 1e-3;
const std::vector<std::string> kTips = {"ff_tip", "mf_tip", "rf_tip", "lf_tip", "th_tip"};
const Vector3d kGravity(0, 0, -9.81);

Robot make_hand() {
  Robot robot(load_model(kArmUrdf), RobotOptions());
  robot.set_joints(ready_pose());
  return robot;
}

void hand_run(Robot& robot, double seconds) {
  for (int i = 0, n = std::lround(seconds / kHandDt); i < n; ++i) robot.step(kHandDt);
}

/// Mass and centre of mass of each part: a finger is a cylinder of 100 g from 5 to 85 mm, divided
/// at 10, 38 and 60 mm; the remainder gives 4.8 kg with the identified centre for straight fingers.
struct Part {
  std::string link;
  double mass;
  Vector3d centre;  // in the link's frame
};

std::vector<Part> parts() {
  std::vector<Part> parts{{"hand", 4.3, Vector3d(-0.000907, -0.0007256, 0.100758)}};
  for (const std::string finger : {"ff", "mf", "rf", "lf", "th"}) {
    parts.push_back({finger + "_knuckle", 0.00625, Vector3d(0, 0, 0.0075)});
    parts.push_back({finger + "_proximal", 0.035, Vector3d(0, 0, 0.024)});
    parts.push_back({finger + "_middle", 0.0275, Vector3d(0, 0, 0.011)});
    parts.push_back({finger + "_distal", 0.03125, Vector3d(0, 0, 0.0125)});
  }
  return parts;
}

double total_mass() {
  double mass = 0;
  for (const Part& part : parts()) mass += part.mass;
  return mass;
}

Vector3d centre_of_mass(const Robot& robot) {
  Vector3d sum = Vector3d::Zero();
  for (const Part& part : parts()) sum += part.mass * (robot.link_pose(part.link) * part.centre);
  return sum / total_mass();
}

/// Half way to the closed limit of every joint; `spread` of those that do not close.
VectorXd curled(const Robot& robot, double spread = 0.1) {
  VectorXd q(robot.hand_joint_names().size());
  for (int i = 0; i < q.size(); ++i) {
    const std::string& name = robot.hand_joint_names()[i];
    const bool closes = name.substr(3) != "j5" && (name.substr(3) != "j4" || name == "th_j4");
    q(i) = closes ? 0.5 * robot.hand_limits().upper(i) : spread;
  }
  return q;
}

int index_of(const Robot& robot, const std::string& name) {
  const auto& names = robot.hand_joint_names();
  return std::find(names.begin(), names.end(), name) - names.begin();
}

TEST(Hand, HasFourJointsAFinger) {
  const Robot robot = make_hand();
  EXPECT_EQ(robot.hand_joint_names().size(), 20u);
  for (const std::string& tip : kTips) {
    const std::vector<int> chain = robot.hand_joints_to(tip);
    ASSERT_EQ(chain.size(), 4u) << tip;
    for (int i : chain) EXPECT_EQ(robot.hand_joint_names()[i].substr(0, 2), tip.substr(0, 2));
    EXPECT_EQ(robot.hand_joint_names()[chain.back()].substr(3), "j1");
  }
  EXPECT_TRUE(robot.hand_joints_to("flange").empty());
  EXPECT_THROW(robot.hand_joints_to("sixth_tip"), std::invalid_argument);
}

TEST(Hand, FingersCloseTowardsTheThumbAndOpenAwayFromIt) {
  Robot robot = make_hand();
  const auto in_hand = [&robot](const std::string& tip) {
    return Vector3d((robot.link_pose("hand").inverse() * robot.link_pose(tip)).translation());
  };
  std::map<std::string, Vector3d> straight;
  for (const std::string& tip : kTips) straight[tip] = in_hand(tip);
  EXPECT_NEAR(straight["mf_tip"].x() - straight["th_tip"].x(), 0.074, 1e-12);
  EXPECT_NEAR(straight["mf_tip"].z(), 0.26, 1e-12);
  robot.set_hand(curled(robot, 0));
  for (const std::string& tip : kTips) {
    const double side = tip == "th_tip" ? -1 : 1;
    EXPECT_LT(side * in_hand(tip).x(), side * straight[tip].x() - 0.03) << tip;
    EXPECT_LT(in_hand(tip).z(), straight[tip].z() - 0.02) << tip;
  }
  robot.set_hand(robot.hand_limits().lower.cwiseMin(0));
  for (const std::string& tip : kTips) {
    const double side = tip == "th_tip" ? -1 : 1;
    EXPECT_GT(side * in_hand(tip).x(), side * straight[tip].x() + 0.015) << tip;
  }
}

TEST(Hand, KeepsItsPlaceUntilItIsCommanded) {
  Robot robot = make_hand();
  for (int i = 0; i < 1500; ++i) {
    const double t = i * kHandDt;
    robot.command_twist({Vector3d(0.3 * std::sin(9 * t), 0.3 * std::cos(8 * t), 0),
                         Vector3d(std::sin(7 * t), 0, 1.5 * std::sin(6 * t))});
    robot.step(kHandDt);
    ASSERT_EQ(robot.hand_positions().cwiseAbs().maxCoeff(), 0);
    ASSERT_EQ(robot.hand_velocities().cwiseAbs().maxCoeff(), 0);
  }
  EXPECT_EQ(robot.hand_torques().cwiseAbs().maxCoeff(), 0);
}

TEST(Hand, ReachesItsTargetsWithinSpeedAndTorque) {
  Robot robot = make_hand();
  const Vector3d still = robot.flange_pose().translation();
  double shaken = 0;
  for (const VectorXd& target : {curled(robot), VectorXd(robot.hand_limits().upper),
                                 VectorXd(robot.hand_limits().lower), curled(robot, -0.3)}) {
    robot.command_hand(target);
    for (int i = 0; i < 1200; ++i) {
      robot.step(kHandDt);
      shaken = std::max(shaken, (robot.flange_pose().translation() - still).norm());
      const Eigen::ArrayXd speed = robot.hand_velocities().cwiseAbs();
      ASSERT_TRUE((speed < 1.1 * robot.hand_limits().velocity.array()).all());
      ASSERT_TRUE(
          (robot.hand_torques().array().abs() <= robot.hand_limits().torque.array() + 1e-12).all());
    }
    EXPECT_LT((robot.hand_positions() - target).cwiseAbs().maxCoeff(), 1e-3);
    EXPECT_LT(robot.hand_velocities().cwiseAbs().maxCoeff(), 1e-3);
  }
  EXPECT_LT(shaken, 1e-4);  // the arm holds the hand meanwhile
  RecordProperty("shaken_mm", std::to_string(1e3 * shaken));
  // Beyond the limits: clamped.
  robot.command_hand(VectorXd::Constant(20, 10));
  hand_run(robot, 1.5);
  EXPECT_LT((robot.hand_positions() - robot.hand_limits().upper).cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_THROW(robot.command_hand(VectorXd::Zero(19)), std::invalid_argument);
  EXPECT_THROW(robot.command_hand(VectorXd::Constant(20, NAN)), std::invalid_argument);
  EXPECT_THROW(robot.set_hand(VectorXd::Constant(20, 3)), std::invalid_argument);
}

TEST(Hand, FingersYieldToAContactByTheirStiffness) {
  Robot robot = make_hand();
  robot.command_hand(VectorXd::Zero(20));
  hand_run(robot, 0.2);
  const math::Pose X_WT = robot.link_pose("ff_tip");
  const Vector3d closing = -robot.link_pose("hand").linear().col(0);
  const double force = 0.3;
  robot.set_link_load("ff_tip", {force * closing, Vector3d::Zero()}, X_WT.translation());
  hand_run(robot, 1);
  // Levers from the joints to the tip's centre; small angles.
  const double stiffness = RobotOptions().hand.stiffness;
  const VectorXd q = robot.hand_positions();
  EXPECT_NEAR(q(index_of(robot, "ff_j3")), force * 0.080 / stiffness, 2e-5);
  EXPECT_NEAR(q(index_of(robot, "ff_j2")), force * 0.042 / stiffness, 2e-5);
  EXPECT_NEAR(q(index_of(robot, "ff_j1")), force * 0.020 / stiffness, 2e-5);
  EXPECT_NEAR(q(index_of(robot, "mf_j3")), 0, 1e-5);
  EXPECT_NEAR(robot.link_load("ff_tip").force.norm(), force, 1e-12);
  EXPECT_EQ(robot.link_load("mf_tip").force.norm(), 0);
}

TEST(Hand, TorqueLimitGivesWay) {
  Robot robot = make_hand();
  robot.command_hand(VectorXd::Zero(20));
  hand_run(robot, 0.1);
  const Vector3d closing = -robot.link_pose("hand").linear().col(0);
  // 1.2 N m at the finger's base, above its 1 N m.
  robot.set_link_load("ff_tip", {15 * closing, Vector3d::Zero()},
                      robot.link_pose("ff_tip").translation());
  hand_run(robot, 0.5);
  const int j3 = index_of(robot, "ff_j3");
  EXPECT_GT(robot.hand_positions()(j3), 0.6);  // a spring alone would yield by 0.5
  EXPECT_LE(std::abs(robot.hand_torques()(j3)), 1 + 1e-12);
  EXPECT_LT(robot.hand_positions()(j3), robot.hand_limits().upper(j3) + 0.01);
}

TEST(Hand, SensorFeelsTheWeightOfCurledFingersAndWhatTheyTouch) {
  Robot robot = make_hand();
  robot.command_hand(curled(robot));
  hand_run(robot, 1.5);
  EXPECT_NEAR(total_mass(), 4.8, 1e-12);
  const Vector3d p_S = robot.link_pose("sensor").translation();
  const Eigen::Matrix3d R_WS = robot.link_pose("sensor").linear();
  const Vector3d weight = 4.8 * kGravity;
  math::Wrench F = robot.sensor_wrench();
  EXPECT_LT((R_WS * F.force + weight).norm(), 1e-3);
  EXPECT_LT((R_WS * F.torque + (centre_of_mass(robot) - p_S).cross(weight)).norm(), 1e-4);

  const math::Wrench touch{Vector3d(0.3, -0.2, 0.4), Vector3d(0.002, 0.001, -0.003)};
  robot.set_link_load("th_tip", touch, robot.link_pose("th_tip").translation());
  hand_run(robot, 1.5);
  F = robot.sensor_wrench();
  const Vector3d p_T = robot.link_pose("th_tip").translation();
  EXPECT_LT((R_WS * F.force + weight + touch.force).norm(), 1e-3);
  EXPECT_LT((R_WS * F.torque + (centre_of_mass(robot) - p_S).cross(weight) + touch.torque +
             (p_T - p_S).cross(touch.force))
                .norm(),
            1e-3);
}

TEST(Hand, SensorImpulseIsTheFingersChangeOfMomentum) {
  Robot robot = make_hand();
  robot.command_hand(VectorXd::Zero(20));
  hand_run(robot, 0.1);
  const auto step_momentum = [&robot] {
    const Vector3d before = centre_of_mass(robot);
    robot.step(kHandDt);
    return Vector3d(4.8 / kHandDt * (centre_of_mass(robot) - before));
  };
  const Vector3d first = step_momentum();
  robot.command_hand(curled(robot));
  Vector3d impulse = Vector3d::Zero();
  double largest = 0;
  for (int i = 0; i < 400; ++i) {
    const Vector3d change = step_momentum() - first;
    impulse += kHandDt *
               (robot.link_pose("sensor").linear() * robot.sensor_wrench().force + 4.8 * kGravity);
    largest = std::max(largest, change.norm());
    ASSERT_LT((impulse - change).norm(), 1e-3) << "after " << i << " ms";
  }
  EXPECT_GT(largest, 0.03);  // N s
}

}  // namespace
}  // namespace palpate::robot
