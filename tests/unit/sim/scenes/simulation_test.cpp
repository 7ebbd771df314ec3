#include "sim/scenes/simulation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "tests/support/plant_momentum.hpp"
#include "tests/unit/sim/scenes/stage.hpp"

namespace palpate::scenes {
namespace {

using Eigen::Vector3d;

constexpr double kHandMass = 4.8;
const Vector3d kHandCentre(0.0015, -0.00065, 0.1137);  // in S

TEST(Simulation, StartsAtTheSceneFilesGraspWithTheObjectAtRest) {
  Stage stage(kControl, {});
  const math::Pose X_OG = stage.simulation.grasp_in_object();
  EXPECT_LT((X_OG.translation() - Vector3d(0.47, 0.03, 0.03)).norm(), 1e-6);
  EXPECT_LT(math::log_rotation(X_OG.linear()).norm(), 1e-6);
  EXPECT_TRUE(stage.simulation.robot().link_pose("grasp").isApprox(
      stage.simulation.robot().flange_pose() * stage.simulation.scene().X_EG, 1e-9));
  const Eigen::Matrix3Xd before = stage.simulation.plant().positions();
  stage.run(0.5);
  EXPECT_LT((stage.simulation.plant().positions() - before).cwiseAbs().maxCoeff(), 2e-4);
  EXPECT_LT(stage.simulation.plant().kinetic_energy(), 1e-7);
}

TEST(Simulation, AllChannelsAtTheirRates) {
  Stage stage(kControl);
  stage.run(2);
  EXPECT_NEAR(stage.sent<ft_wrench_t>("FT_WRENCH").size(), 2000, 2);
  EXPECT_NEAR(stage.sent<imu_t>("IMU").size(), 600, 3);
  EXPECT_NEAR(stage.sent<robot_state_t>("ROBOT_STATE").size(), 1000, 2);
  EXPECT_NEAR(stage.sent<hand_state_t>("HAND_STATE").size(), 200, 2);
  EXPECT_EQ(stage.sent<shape_t>("TRUTH_SHAPE").size(), 200u);
  EXPECT_EQ(stage.sent<truth_contact_t>("TRUTH_CONTACT").size(), 200u);
  EXPECT_EQ(stage.sent<shape_mesh_t>("TRUTH_MESH").size(), 2u);

  const auto hand = stage.sent<hand_state_t>("HAND_STATE").back();
  EXPECT_EQ(hand.grasp, hand_state_t::GRASP_HOLDING);
  EXPECT_EQ(hand.fingertip_count, 5);
  // Opposite fingertips touch a bar of 60 mm with skins of 7 mm radius.
  EXPECT_NEAR(hand.fingertip_position[0][0], 0.037, 1e-3);
  EXPECT_NEAR(hand.fingertip_position[4][0], -0.037, 1e-3);
}

TEST(Simulation, StampsRiseByOneInOneSession) {
  Stage stage(kControl);
  stage.run(0.1);
  std::int32_t seq = 0;
  std::int64_t utime = -1;
  for (const auto& m : stage.sent<ft_wrench_t>("FT_WRENCH")) {
    EXPECT_EQ(m.seq, ++seq);
    EXPECT_GT(m.utime, utime);
    EXPECT_EQ(m.session, 1);
    utime = m.utime;
  }
  EXPECT_GE(seq, 98);
}

TEST(Simulation, TwoRunsAreEqualToTheBitAndSeedsMatter) {
  const auto run = [](const std::vector<std::string>& overrides) {
    Stage stage(kSixPoses, coarse(overrides));
    stage.run(1.5);
    return stage.messages;
  };
  const auto first = run({}), again = run({}), other = run({"seed=2"});
  ASSERT_EQ(first.size(), again.size());
  ASSERT_GT(first.size(), 3000u);
  for (std::size_t i = 0; i < first.size(); ++i) {
    ASSERT_EQ(first[i].channel, again[i].channel) << i;
    ASSERT_EQ(first[i].data, again[i].data) << i << " " << first[i].channel;
  }
  bool differs = false;
  for (std::size_t i = 0; i < std::min(first.size(), other.size()); ++i)
    differs = differs || (first[i].channel == "FT_WRENCH" && first[i].data != other[i].data);
  EXPECT_TRUE(differs);
}

TEST(Simulation, ForcesOnHandAndObjectBalanceAtRest) {
  Stage stage(kSixPoses);
  stage.run(5);  // keeps its first pose
  const Simulation& s = stage.simulation;
  const Eigen::Matrix3d R_WO = s.scene().X_WO.linear();
  const Vector3d g(0, 0, -9.81);
  const object::HyperelasticPlant& plant = s.plant();

  // Object alone: hand, rig and weight.
  const Vector3d weight_O = plant.nodal_masses().sum() * (R_WO.transpose() * g);
  const Vector3d object_sum = plant.hand_wrench().force + plant.clamp_wrench().force + weight_O;
  EXPECT_LT(object_sum.norm(), 2e-3);

  // Hand alone: sensor, weight and the object's reaction, force and torque about S.
  const math::Pose X_WS = s.robot().link_pose("sensor");
  const math::Wrench F_S = s.robot().sensor_wrench();
  const Vector3d reaction = -(R_WO * plant.hand_wrench().force);
  const Vector3d hand_sum = X_WS.linear() * F_S.force + kHandMass * g + reaction;
  EXPECT_LT(hand_sum.norm(), 1e-3);
  const Vector3d p_G = s.robot().link_pose("grasp").translation();
  const Vector3d torque =
      X_WS.linear() * F_S.torque + (X_WS.linear() * kHandCentre).cross(kHandMass * g) +
      (p_G - X_WS.translation()).cross(reaction) - R_WO * plant.hand_wrench().torque;
  EXPECT_LT(torque.norm(), 1e-3);
  EXPECT_GT(reaction.norm(), 1);  // the bar does pull
}

TEST(Simulation, HandFeelsTheObjectsReactionWhileItMoves) {
  // The forces on the hand other than from its joint, its weight and its inertia are the object's
  // reaction.
  Stage stage(kSixPoses);
  stage.run(1);
  Simulation& s = stage.simulation;
  const Eigen::Matrix3d R_WO = s.scene().X_WO.linear();
  const auto centre = [&s] { return Vector3d(s.robot().link_pose("sensor") * kHandCentre); };
  std::array<Vector3d, 3> p{centre(), centre(), centre()};
  double wrong = 0, all = 0;
  for (int i = 0; i < 2500; ++i) {
    s.step();
    p = {p[1], p[2], centre()};
    if (i < 2) continue;
    const Vector3d acceleration =
        (p[2] - 2 * p[1] + p[0]) / (Simulation::kPeriod * Simulation::kPeriod);
    const Vector3d joint = s.robot().link_pose("sensor").linear() * s.robot().sensor_wrench().force;
    const Vector3d felt = kHandMass * (acceleration - Vector3d(0, 0, -9.81)) - joint;
    const Vector3d reaction = -(R_WO * s.plant().hand_wrench().force);
    wrong += (felt - reaction).squaredNorm();
    all += reaction.squaredNorm();
  }
  EXPECT_GT(std::sqrt(all / 2500), 1);  // N
  std::printf("felt within %.2e of the reaction\n", std::sqrt(wrong / all));
  EXPECT_LT(std::sqrt(wrong / all), 0.01);
}

TEST(Simulation, ImpulseEqualsTheChangeOfMomentum) {
  // Hand and object together, in motion: sensor, rig and weights are the only external loads.
  Stage stage(kSixPoses, coarse({"object.damping=0", "object.pads.damping=0"}));
  stage.run(1.2);
  const Simulation& s = stage.simulation;
  const Eigen::Matrix3d R_WO = s.scene().X_WO.linear();
  const auto centre = [&s] { return Vector3d(s.robot().link_pose("sensor") * kHandCentre); };
  const auto object_momentum = [&] { return Vector3d(R_WO * object::linear_momentum(s.plant())); };
  const double object_mass = s.plant().nodal_masses().sum();
  const Vector3d object_first = object_momentum();
  Vector3d last = centre();
  stage.simulation.step();
  Vector3d now = centre();
  const Vector3d hand_first = kHandMass * (now - last) / Simulation::kPeriod;
  Vector3d impulse = Vector3d::Zero();
  double largest = 0;
  for (int i = 0; i < 800; ++i) {
    stage.simulation.step();
    last = now;
    now = centre();
    const Vector3d sensor =
        s.robot().link_pose("sensor").linear() * s.robot().sensor_wrench().force;
    const Vector3d rig = R_WO * s.plant().clamp_wrench().force;
    impulse +=
        Simulation::kPeriod * (sensor + rig + (kHandMass + object_mass) * Vector3d(0, 0, -9.81));
    const Vector3d change = kHandMass * (now - last) / Simulation::kPeriod - hand_first +
                            object_momentum() - object_first;
    largest = std::max(largest, change.norm());
    ASSERT_LT((impulse - change).norm(), 0.01) << "after " << i << " ms";
  }
  EXPECT_GT(largest, 0.2);  // N s
}

TEST(Simulation, ReachesAllSixPosesWithMargin) {
  Stage stage(kSixPoses);
  Simulation& s = stage.simulation;
  const MotionPlan& plan = *s.scene().motion;
  const robot::JointLimits& limits = s.robot().limits();
  double along = 0;
  double next = plan.start_delay();
  for (const Leg& leg : plan.legs()) {
    next += leg.move;
    while (s.time() < next + 0.3) {
      s.step();
      along = std::max(along,
                       (s.grasp_in_object().translation() - s.grasp_target().translation()).norm());
      const Eigen::ArrayXd q = s.robot().joint_positions();
      ASSERT_GT((limits.upper.array() - q).minCoeff(), 0.15) << "at " << s.time();
      ASSERT_GT((q - limits.lower.array()).minCoeff(), 0.15) << "at " << s.time();
      ASSERT_LT(
          (s.robot().joint_velocities().cwiseAbs().array() / limits.velocity.array()).maxCoeff(),
          0.8);
      ASSERT_LT((s.robot().joint_torques().cwiseAbs().array() / limits.torque.array()).maxCoeff(),
                0.8);
    }
    const math::Pose X = s.grasp_in_object(), target = s.grasp_target();
    EXPECT_LT((X.translation() - target.translation()).norm(), 1e-4);
    EXPECT_LT(math::log_rotation(X.linear() * target.linear().transpose()).norm(), 1e-4);
    const Vector3d moved = X.translation() - Vector3d(0.47, 0.03, 0.03);
    EXPECT_LT((moved - leg.translation).norm(), 1e-3);
    next += leg.hold;
  }
  EXPECT_LT(along, 1e-3);  // on the way, too
  RecordProperty("largest_deviation_mm", std::to_string(1e3 * along));
}

twist_command_t twist(std::int32_t seq, const math::Vector6d& value, int valid = 1) {
  twist_command_t message{};
  message.seq = seq;
  message.session = 5;
  message.valid = valid;
  Eigen::Map<math::Vector6d>(message.twist) = value;
  return message;
}

TEST(Simulation, ObeysTwistCommandsUntilTheyStop) {
  Stage stage(kControl);
  Simulation& s = stage.simulation;
  bus::TypedPublisher<twist_command_t> commands(*stage.daemon, "TWIST_COMMAND");
  const math::Pose start = s.grasp_in_object();
  math::Vector6d up = math::Vector6d::Zero();
  up(2) = 0.05;
  int seq = 0;
  for (int i = 0; i < 400; ++i) {
    commands.publish(twist(++seq, up));
    s.step();
  }
  EXPECT_EQ(s.commands().accepted(), 400);
  EXPECT_NEAR(s.robot().flange_twist().linear.z(), 0.05, 5e-4);
  EXPECT_NEAR(s.grasp_in_object().translation().z() - start.translation().z(), 0.02, 5e-4);
  stage.run(0.3);  // silence
  EXPECT_LT(s.robot().flange_twist().linear.norm(), 1e-4);

  commands.publish(twist(++seq, up));
  s.step();
  commands.publish(twist(++seq, up, 0));  // not valid: stop
  stage.run(0.08);
  EXPECT_LT(s.robot().flange_twist().linear.norm(), 1e-3);
}

TEST(Simulation, ObeysJointVelocityCommands) {
  Stage stage(kControl);
  Simulation& s = stage.simulation;
  bus::TypedPublisher<joint_velocity_command_t> commands(*stage.daemon, "JOINT_VELOCITY_COMMAND");
  const double before = s.robot().joint_positions()(6);
  joint_velocity_command_t message{};
  message.session = 5;
  message.valid = 1;
  message.joint_count = 7;
  message.dq[6] = 0.2;
  for (int i = 0; i < 300; ++i) {
    ++message.seq;
    commands.publish(message);
    s.step();
  }
  EXPECT_NEAR(s.robot().joint_positions()(6) - before, 0.06, 2e-3);
}

TEST(Simulation, BrokenAndOldCommandsAreRejected) {
  Stage stage(kControl);
  Simulation& s = stage.simulation;
  bus::TypedPublisher<twist_command_t> commands(*stage.daemon, "TWIST_COMMAND");
  math::Vector6d value = math::Vector6d::Constant(0.1);
  commands.publish(twist(5, math::Vector6d::Zero()));
  value(3) = std::numeric_limits<double>::quiet_NaN();
  commands.publish(twist(6, value));
  commands.publish(twist(4, math::Vector6d::Constant(0.1)));  // older than one already seen
  stage.run(0.05);
  EXPECT_EQ(s.commands().accepted(), 1);
  EXPECT_EQ(s.commands().rejected(), 2);
  EXPECT_LT(s.robot().flange_twist().linear.norm(), 1e-5);
}

TEST(Simulation, SensorsSeeTheTruthWithinTheirNoise) {
  Stage stage(kSixPoses, coarse({"sensors.force_torque.bias=[0.5, 0, 0, 0, 0, 0]"}));
  stage.run(5);
  const Simulation& s = stage.simulation;
  const auto robot = stage.sent<robot_state_t>("ROBOT_STATE").back();
  const Eigen::Map<const Vector3d> position(robot.position);
  EXPECT_LT((position - s.robot().flange_pose().translation()).norm(), 1e-4);
  EXPECT_TRUE(math::is_unit_quaternion(robot.quaternion));
  EXPECT_LT((math::rotation_from_wxyz(robot.quaternion) - s.robot().flange_pose().linear()).norm(),
            1e-4);
  math::Vector6d mean = math::Vector6d::Zero();
  const auto wrenches = stage.sent<ft_wrench_t>("FT_WRENCH");
  const int n = 500;
  for (int i = 0; i < n; ++i)
    mean += Eigen::Map<const math::Vector6d>((wrenches.end() - 1 - i)->wrench) / n;
  math::Vector6d truth = s.robot().sensor_wrench().vector();
  truth(0) += 0.5;
  EXPECT_LT((mean - truth).head<3>().norm(), 0.01);
  EXPECT_LT((mean - truth).tail<3>().norm(), 0.0005);
}

}  // namespace
}  // namespace palpate::scenes
