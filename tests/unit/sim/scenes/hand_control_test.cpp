#include "sim/scenes/hand_control.hpp"

#include <gtest/gtest.h>

#include "sim/scenes/fingertips.hpp"
#include "tests/unit/sim/scenes/stage.hpp"

namespace palpate::scenes {
namespace {

hand_command_t command(std::int32_t seq, std::int32_t action, double force = 0) {
  hand_command_t message{};
  message.seq = seq;
  message.session = 5;
  message.action = action;
  message.force = force;
  return message;
}

TEST(HandControl, HandStateContainsFingerJointsAndFingertipPoses) {
  Stage stage(kControl);
  Simulation& s = stage.simulation;
  bus::TypedPublisher<hand_command_t> commands(*stage.daemon, "HAND_COMMAND");
  stage.run(0.3);
  const hand_state_t before = stage.sent<hand_state_t>("HAND_STATE").back();
  ASSERT_EQ(before.joint_count, 20);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(before.q[i], 0);  // no command was sent

  commands.publish(command(1, hand_command_t::OPEN));
  stage.run(1);
  EXPECT_EQ(s.commands().accepted(), 1);
  const hand_state_t after = stage.sent<hand_state_t>("HAND_STATE").back();
  const std::vector<std::string>& names = s.robot().hand_joint_names();
  for (int i = 0; i < 20; ++i) {
    EXPECT_NEAR(after.q[i], s.robot().hand_positions()(i), 1e-4) << names[i];
    const bool spreads =
        names[i].substr(3) == "j5" || (names[i] != "th_j4" && names[i].substr(3) == "j4");
    EXPECT_NEAR(after.q[i], spreads ? 0 : s.robot().hand_limits().lower(i), 2e-3) << names[i];
  }
  EXPECT_GT(after.fingertip_position[0][0], before.fingertip_position[0][0] + 0.015);
  EXPECT_LT(after.fingertip_position[4][0], before.fingertip_position[4][0] - 0.015);
  const math::Pose X_ET = s.robot().flange_pose().inverse() * s.robot().link_pose("rf_tip");
  const Eigen::Map<const Eigen::Vector3d> reported(after.fingertip_position[2]);
  EXPECT_LT((reported - X_ET.translation()).norm(), 1e-3);  // its noise is 0.1 mm
}

TEST(HandControl, BrokenAndOldCommandsAreRejected) {
  Stage stage(kControl);
  bus::TypedPublisher<hand_command_t> commands(*stage.daemon, "HAND_COMMAND");
  commands.publish(command(3, hand_command_t::HOLD, 0));  // no force
  commands.publish(command(4, hand_command_t::HOLD, -1));
  commands.publish(command(5, hand_command_t::HOLD, 1e6));
  commands.publish(command(6, 7));                     // no such action
  commands.publish(command(2, hand_command_t::OPEN));  // old
  stage.run(0.1);
  EXPECT_EQ(stage.simulation.commands().accepted(), 0);
  EXPECT_EQ(stage.simulation.commands().rejected(), 5);
  EXPECT_EQ(stage.simulation.robot().hand_positions().norm(), 0);
}

TEST(HandControl, ClosesUntilEveryFingertipFeelsTheBand) {
  robot::Robot robot(robot::load_model(PALPATE_SOURCE_DIR "/sim/robot/lwr_hand.urdf"),
                     robot::RobotOptions());
  HandControl hand(robot);
  ASSERT_TRUE(hand.accept(command(1, hand_command_t::HOLD, 2)));
  const std::vector<std::string> tips = fingertips_of(robot);
  ASSERT_EQ(tips.size(), 5u);
  double most = 0;
  for (int i = 0; i < 2500; ++i) {
    hand.step(i, robot);
    const math::Pose X_WH = robot.link_pose("hand");
    for (const std::string& tip : tips) {  // two walls of 200 N/m, 60 mm apart in the hand
      const double side = tip == "th_tip" ? -1 : 1;
      const Eigen::Vector3d out = side * X_WH.linear().col(0);
      const Eigen::Vector3d p_W = robot.link_pose(tip).translation();
      const double depth = 0.037 - out.dot(p_W - X_WH.translation());
      robot.set_link_load(tip, {std::max(0.0, 200 * depth) * out, Eigen::Vector3d::Zero()}, p_W);
      if (i > 2000) most = std::max(most, robot.link_load(tip).force.norm());
    }
    robot.step(1e-3);
  }
  EXPECT_EQ(hand.grasp().in_band(), 5);
  for (const std::string& tip : tips) EXPECT_GE(robot.link_load(tip).force.norm(), 0.2) << tip;
  EXPECT_LE(most, 2);
}

}  // namespace
}  // namespace palpate::scenes
