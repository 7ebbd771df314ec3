#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "tests/unit/sim/robot/arm.hpp"

namespace palpate::robot {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

std::string link(const std::string& name, double mass, double z) {
  return "<link name='" + name + "'><inertial><origin xyz='0 0 " + std::to_string(z) +
         "'/><mass value='" + std::to_string(mass) +
         "'/><inertia ixx='0.02' ixy='0' ixz='0' iyy='0.02' iyz='0' izz='0.01'/></inertial></link>";
}

std::string joint(int i, const std::string& axis, double up) {
  const std::string n = std::to_string(i), parent = i == 1 ? "base" : "l" + std::to_string(i - 1);
  return "<joint name='j" + n + "' type='revolute'><origin xyz='0 0 " + std::to_string(up) +
         "'/><parent link='" + parent + "'/><child link='l" + n + "'/><axis xyz='" + axis +
         "'/><limit lower='-2.5' upper='2.5' velocity='2' effort='150'/></joint>";
}

std::string fixed(const std::string& name, const std::string& parent, double z) {
  return "<joint name='to_" + name + "' type='fixed'><origin xyz='0 0 " + std::to_string(z) +
         "'/><parent link='" + parent + "'/><child link='" + name + "'/></joint>";
}

/// Six joints with a shoulder, an elbow and a spherical wrist, a tool of 1 kg, no hand; the frames
/// have different names.
std::string six_joint_arm(const std::string& last_joint = joint(6, "0 0 1", 0.06)) {
  return "<robot name='six'>" + link("base", 3, 0) + link("l1", 4, 0.1) + link("l2", 4, 0.2) +
         link("l3", 3, 0.15) + link("l4", 2, 0.05) + link("l5", 1, 0.02) + link("l6", 0.5, 0.01) +
         link("tool", 1, 0.05) + "<link name='tool0'/><link name='board'/>" +
         joint(1, "0 0 1", 0.1) + joint(2, "0 1 0", 0.2) + joint(3, "0 1 0", 0.4) +
         joint(4, "0 0 1", 0.3) + joint(5, "0 1 0", 0.1) + last_joint + fixed("tool0", "l6", 0.02) +
         fixed("tool", "tool0", 0.03) + fixed("board", "tool0", 0.01) + "</robot>";
}

RobotOptions named() {
  RobotOptions options;
  options.frames = {"tool0", "tool", "board"};
  return options;
}

std::string refusal(const std::string& text, const RobotOptions& options = named()) {
  try {
    Robot robot(parse_model(text, "six.urdf"), options);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(OtherRobot, SixJointsWithoutAHandMoveAsCommanded) {
  Robot robot(parse_model(six_joint_arm(), "six.urdf"), named());
  ASSERT_EQ(robot.joint_count(), 6);
  EXPECT_TRUE(robot.hand_joint_names().empty());
  robot.command_hand(VectorXd());
  robot.set_joints(joints({0.3, 0.5, 0.9, 0.2, 0.8, -0.4}));

  // Analytically: up 0.1 and 0.2, then along the two arms and the wrist.
  const auto turn = [](double angle, const Vector3d& axis) {
    return math::Pose(Eigen::AngleAxisd(angle, axis));
  };
  const auto up = [](double z) { return math::Pose(Eigen::Translation3d(0, 0, z)); };
  const Vector3d y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  const math::Pose X = up(0.1) * turn(0.3, z) * up(0.2) * turn(0.5, y) * up(0.4) * turn(0.9, y) *
                       up(0.3) * turn(0.2, z) * up(0.1) * turn(0.8, y) * up(0.06) * turn(-0.4, z) *
                       up(0.02);
  EXPECT_TRUE(robot.flange_pose().isApprox(X, 1e-9));

  const math::Twist twist{Vector3d(0.04, -0.06, 0.05), Vector3d(0.1, 0.2, -0.1)};
  for (int i = 0; i < 1000; ++i) {
    robot.command_twist(twist);
    robot.step(1e-3);
  }
  EXPECT_LT((robot.flange_twist().vector() - twist.vector()).norm(), 1e-3);
  for (int i = 0; i < 500; ++i) robot.step(1e-3);
  EXPECT_LT(robot.flange_twist().vector().norm(), 1e-4);  // the command was not renewed

  // The tool of 1 kg, its centre 0.05 m from S.
  const Vector3d weight = robot.link_pose("tool").linear().transpose() * Vector3d(0, 0, 9.81);
  EXPECT_LT((robot.sensor_wrench().force - weight).norm(), 1e-4);
  EXPECT_LT((robot.sensor_wrench().torque - Vector3d(0, 0, 0.05).cross(weight)).norm(), 1e-4);
}

TEST(OtherRobot, BrokenOnesAreRefusedWithAReason) {
  EXPECT_EQ(refusal(six_joint_arm()), "");
  const std::string good = joint(6, "0 0 1", 0.06);
  const auto broken = [&good](const std::string& what, const std::string& by) {
    std::string text = good;
    return six_joint_arm(text.replace(text.find(what), what.size(), by));
  };
  EXPECT_NE(refusal(broken("parent link='l5'", "parent link='l9'")), "");  // no such link
  EXPECT_NE(refusal(broken("parent link='l5'", "parent link='l6'")), "");  // a loop
  EXPECT_NE(refusal(broken("type='revolute'", "type='hinge'")), "");       // no such type
  EXPECT_NE(refusal(broken("name='j6'", "name='j5'")), "");                // twice the same
  EXPECT_NE(refusal(broken("effort='150'", "effort='0'")).find("effort"), std::string::npos);
  EXPECT_NE(refusal(broken("effort='150'", "effort='nan'")), "");
  EXPECT_NE(refusal(broken("velocity='2' ", "")), "");
  EXPECT_NE(refusal(six_joint_arm("")), "");  // two roots
  EXPECT_NE(refusal(six_joint_arm(), RobotOptions()).find("flange"), std::string::npos);
}

std::string all(const std::vector<std::string>& remarks) {
  std::string text;
  for (const std::string& remark : remarks) text += remark + "\n";
  return text;
}

std::string remarks_where(const std::string& what, const std::string& by) {
  std::string text = six_joint_arm();
  return all(parse_model(text.replace(text.find(what), what.size(), by), "six.urdf").remarks);
}

TEST(OtherRobot, MassesAndInertiasThatWouldMakeItUnstableAreReported) {
  EXPECT_EQ(all(parse_model(six_joint_arm(), "six.urdf").remarks), "");
  EXPECT_EQ(all(load_model(PALPATE_SOURCE_DIR "/sim/robot/lwr_hand.urdf").remarks), "");
  // The fifth link, of 1 kg, between one of 2 and one of 0.5 kg with its tool.
  const std::string light = remarks_where("mass value='1.000000'", "mass value='0.0001'");
  EXPECT_NE(light.find("l4 of 2 kg and l5 of 0.0001 kg"), std::string::npos) << light;
  EXPECT_NE(light.find("joint j6 joins l5 of 0.0001 kg and l6 of 1.5 kg"), std::string::npos)
      << "with the tool that is fixed to it: " << light;
  const std::string none = remarks_where("mass value='1.000000'", "mass value='0'");
  EXPECT_NE(none.find("link l5, which joint j5 moves, weighs nothing"), std::string::npos) << none;
  const std::string flat = remarks_where("izz='0.01'", "izz='0.05'");
  EXPECT_NE(flat.find("link base has principal moments 0.02, 0.02 and 0.05"), std::string::npos)
      << flat;
  const std::string negative = remarks_where("izz='0.01'", "izz='-0.01'");
  EXPECT_NE(negative.find("all must be above zero"), std::string::npos) << negative;
}

TEST(OtherRobot, ReportsTheOptionsThatDartItselfUses) {
  Robot robot(parse_model(six_joint_arm(), "six.urdf"), named());
  robot.step(2e-3);
  const std::string options = robot.effective_options();
  EXPECT_NE(options.find("step 2 ms, gravity [0, 0, -9.81] m/s^2, 1 skeletons"), std::string::npos)
      << options;
  EXPECT_NE(options.find("solved by "), std::string::npos) << options;
}

}  // namespace
}  // namespace palpate::robot
