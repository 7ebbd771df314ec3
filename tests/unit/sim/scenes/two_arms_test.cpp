// The second arm of a scene: its keys, its channels, and its effect on the object and the first
// arm.

#include <gtest/gtest.h>

#include <palpate/truth_contact_t.hpp>

#include "tests/unit/sim/scenes/stage.hpp"

namespace palpate::scenes {
namespace {

using Eigen::Vector3d;

const std::string kTwoHands = PALPATE_SOURCE_DIR "/sim/scenes/bar_two_hands.yaml";
const Vector3d kGravity(0, 0, -9.81);

std::string refusal(const std::string& file, const std::vector<std::string>& overrides) {
  try {
    read_scene(config::Node::load_file(file, overrides));
  } catch (const config::Error& error) {
    return error.what();
  }
  return "";
}

/// Softer pads, larger time steps.
std::vector<std::string> soft(std::vector<std::string> overrides = {}) {
  overrides.insert(overrides.end(), {"object.elements=[10, 1, 1]", "object.pads.stiffness=1e4"});
  return overrides;
}

TEST(TwoArms, KeysReachTheScene) {
  const Scene s = read_scene(config::Node::load_file(
      kTwoHands,
      {"second_arm.base_in_first={position: [2, 0, 0.5], rpy_deg: [0, 90, 0]}",
       "second_arm.sensors.force_torque.bias=[0.05, 0, 0, 0, 0, 0]", "object.pads.stiffness=3e3"}));
  ASSERT_TRUE(s.second_arm);
  ASSERT_EQ(s.plant.grasps.size(), 2u);
  EXPECT_FALSE(s.plant.clamp);
  EXPECT_EQ(s.plant.grasps[1].stiffness, 3e3);
  EXPECT_EQ(s.plant.grasps[1].patch.upper.x(), 0.05);
  // A fall along z of W is along x of a base that is tilted forwards.
  EXPECT_LT((s.second_arm->robot.gravity_W - Vector3d(9.81, 0, 0)).norm(), 1e-9);
  EXPECT_EQ(s.second_arm->sensors.force_torque.bias(0), 0.05);
  EXPECT_EQ(s.sensors.force_torque.bias(0), 0);
  EXPECT_EQ(s.second_arm->motion->legs().size(), s.motion->legs().size());
}

TEST(TwoArms, WrongKeysAreNamed) {
  EXPECT_NE(refusal(kTwoHands, {"second_arm.speed=1"}).find("speed"), std::string::npos);
  EXPECT_NE(refusal(kControl, {"second_arm={urdf: ../robot/lwr_hand.urdf}"}).find("second_grasp"),
            std::string::npos);
  EXPECT_NE(refusal(kControl, {"object.second_grasp_box={lower: [0, 0, 0], upper: [0.05, 1, 1]}"})
                .find("second_arm"),
            std::string::npos);
  EXPECT_THROW(Stage(kTwoHands, soft({"second_arm.initial_joints=[0, 0]"})), config::Error);
}

TEST(TwoArms, SecondOneUsesItsOwnChannels) {
  Stage stage(kTwoHands, soft());
  stage.run(1);
  const auto near = [](std::size_t count, int expected) {
    EXPECT_NEAR(static_cast<double>(count), expected, 3);
  };
  near(stage.sent<ft_wrench_t>("FT_WRENCH_1").size(), 1000);
  near(stage.sent<imu_t>("IMU_1").size(), 300);
  near(stage.sent<robot_state_t>("ROBOT_STATE_1").size(), 500);
  near(stage.sent<hand_state_t>("HAND_STATE_1").size(), 100);
  EXPECT_EQ(stage.sent<hand_state_t>("HAND_STATE_1").back().grasp, hand_state_t::GRASP_HOLDING);
  EXPECT_EQ(stage.sent<truth_contact_t>("TRUTH_CONTACT").back().grasp_count, 2);

  // Its noise is independent.
  const auto first = stage.sent<imu_t>("IMU").back(), second = stage.sent<imu_t>("IMU_1").back();
  EXPECT_NE(first.acceleration[0], second.acceleration[0]);

  // In its own base; the flange is at the pose required by the object's other end.
  const robot_state_t state = stage.sent<robot_state_t>("ROBOT_STATE_1").back();
  const Arm& arm = stage.simulation.arm(1);
  EXPECT_LT((Vector3d(state.position) - arm.robot().flange_pose().translation()).norm(), 1e-3);
  EXPECT_LT((arm.grasp_in_object().translation() - Vector3d(0.03, 0.03, 0.03)).norm(), 1e-3);
}

// Both hands carry the weight, and the pull of one is felt by the other: force and torque, on the
// object and, by the wrist sensors, on the arms.
TEST(TwoArms, WrenchesOfBothHandsAndTheWeightSumToZeroAtRest) {
  Stage stage(kTwoHands, soft({"object.damping=20"}));
  stage.run(5);  // keeps its first pose, stretched
  const Simulation& s = stage.simulation;
  const object::HyperelasticPlant& plant = s.plant();
  const Eigen::Matrix3d R_OW = s.scene().X_WO.linear().transpose();
  const Vector3d weight = plant.nodal_masses().sum() * (R_OW * kGravity);
  const Vector3d centre = plant.positions() * plant.nodal_masses() / plant.nodal_masses().sum();
  const double pull = plant.hand_wrench(0).force.norm();
  EXPECT_GT(pull, 3) << "N: it is stretched";

  const Vector3d force = plant.hand_wrench(0).force + plant.hand_wrench(1).force + weight;
  EXPECT_LT(force.norm(), 1e-3 * pull);
  Vector3d torque = centre.cross(weight);
  for (int i = 0; i < 2; ++i) {
    torque += plant.hand_wrench(i).torque +
              s.arm(i).grasp_in_object().translation().cross(plant.hand_wrench(i).force);
  }
  EXPECT_LT(torque.norm(), 1e-3 * pull * 0.5) << "N m, by the bar's length";

  // The sensor carries the hand and the reaction of the object.
  constexpr double kHandMass = 4.8;
  for (int i = 0; i < 2; ++i) {
    const Arm& arm = s.arm(i);
    const Eigen::Matrix3d R_WS = arm.robot().link_pose("sensor").linear();
    const Vector3d reaction = -(arm.scene().X_WO.linear() * plant.hand_wrench(i).force);
    const Vector3d sum = R_WS * arm.robot().sensor_wrench().force + kHandMass * kGravity + reaction;
    EXPECT_LT(sum.norm(), 1e-3 * pull) << i;
  }
}

TEST(TwoArms, TruthContainsBothGrasps) {
  Stage stage(kTwoHands, soft());
  stage.run(1.5);
  const truth_contact_t truth = stage.sent<truth_contact_t>("TRUTH_CONTACT").back();
  const Simulation& s = stage.simulation;
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(Vector3d(truth.grasp_position[i]), s.arm(i).grasp_in_object().translation()) << i;
    EXPECT_EQ(math::Vector6d(truth.grasp_wrench[i]), s.plant().hand_wrench(i).vector()) << i;
  }
}

TEST(TwoArms, EachObeysItsOwnCommands) {
  Stage stage(PALPATE_SOURCE_DIR "/sim/scenes/bar_two_hands_control.yaml", soft());
  const Simulation& s = stage.simulation;
  ASSERT_FALSE(s.arm(1).scene().motion);
  bus::TypedPublisher<twist_command_t> second(*stage.daemon, "TWIST_COMMAND_1");
  twist_command_t message{};
  message.session = 5;
  message.valid = 1;
  message.grasp = 1;
  message.twist[2] = 0.02;
  const Vector3d before[2] = {s.arm(0).grasp_in_object().translation(),
                              s.arm(1).grasp_in_object().translation()};
  for (int i = 0; i < 500; ++i) {
    message.seq = i + 1;
    second.publish(message);
    stage.run(0.001);
  }
  EXPECT_NEAR(s.arm(1).grasp_in_object().translation().z() - before[1].z(), 0.01, 1e-3);
  EXPECT_LT((s.arm(0).grasp_in_object().translation() - before[0]).norm(), 1e-3);
  EXPECT_EQ(s.arm(1).commands().accepted(), 500);
  EXPECT_EQ(s.arm(0).commands().accepted(), 0);

  message.seq = 501;
  message.grasp = 0;  // of the other hand
  second.publish(message);
  stage.run(0.001);
  EXPECT_EQ(s.arm(1).commands().rejected(), 1);
  stage.run(1);
  EXPECT_LT(s.arm(1).robot().flange_twist().linear.norm(), 1e-3) << "stops when commands stop";
}

}  // namespace
}  // namespace palpate::scenes
