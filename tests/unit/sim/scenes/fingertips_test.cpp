#include "sim/scenes/fingertips.hpp"

#include <gtest/gtest.h>

#include <palpate/truth_touch_t.hpp>

#include "core/sensing/biotac_geometry.hpp"
#include "tests/support/plant_momentum.hpp"
#include "tests/unit/sim/scenes/stage.hpp"

namespace palpate::scenes {
namespace {

using Eigen::Vector3d;

const std::string kTactile = PALPATE_SOURCE_DIR "/sim/scenes/bar_soft_tactile.yaml";
const std::vector<int> kTouching = {1, 2, 4};  // middle and ring finger below the bar, thumb above
constexpr int kFree = 0;                       // the first finger closes next to it
constexpr double kHeld = 2.5;                  // s, when the hand holds the bar
constexpr double kStill = 4.5;                 // s, when hand and bar have come to rest

/// Frame T of a finger.
math::Pose tip_in_world(const Simulation& s, int finger) {
  return s.robot().link_pose(fingertips_of(s.robot())[finger]);
}

TEST(Fingertips, ForceTorqueSensorFeelsTheObjectsReactionInAStaticHold) {
  Stage stage(kTactile, {});
  stage.run(kStill);
  const Simulation& s = stage.simulation;
  const object::HyperelasticPlant& plant = s.plant();

  // The loads of clamp and weight on the bar are transferred to the fingers: the bar is at rest.
  const Vector3d g = s.scene().X_WO.linear().transpose() * s.scene().robot.gravity_W;
  math::Wrench on_fingers = plant.clamp_wrench();  // about the origin of O, in O
  for (int n = 0; n < plant.positions().cols(); ++n) {
    on_fingers.force += plant.nodal_masses()(n) * g;
    on_fingers.torque += plant.positions().col(n).cross(plant.nodal_masses()(n) * g);
  }
  const math::Pose X_WS = s.robot().link_pose(s.scene().robot.frames.sensor);
  const math::Pose X_SO = X_WS.inverse() * s.scene().X_WO;
  const Vector3d force = X_SO.linear() * on_fingers.force;
  const Vector3d torque = X_SO.linear() * on_fingers.torque +
                          X_SO.translation().cross(X_SO.linear() * on_fingers.force);

  // The same arm and hand in the same posture, without an object.
  robot::Robot empty(robot::load_model(s.scene().urdf), s.scene().robot);
  empty.set_joints(s.robot().joint_positions());
  empty.set_hand(s.robot()
                     .hand_positions()
                     .cwiseMax(empty.hand_limits().lower)
                     .cwiseMin(empty.hand_limits().upper));
  empty.step(Simulation::kPeriod);
  const math::Wrench with = s.robot().sensor_wrench(), without = empty.sensor_wrench();
  EXPECT_GT(force.norm(), 0.05);
  EXPECT_LT((without.force - with.force - force).norm(), 0.01 * force.norm());
  EXPECT_LT((without.torque - with.torque - torque).norm(), 0.01 * torque.norm());
}

TEST(Fingertips, WhatTheFingersGiveIsWhatTheObjectGets) {
  // A free object without weight or damping, hit by the closing hand.
  robot::Robot robot(robot::load_model(PALPATE_SOURCE_DIR "/sim/robot/lwr_hand.urdf"),
                     robot::RobotOptions());
  Eigen::VectorXd q(7);
  q << 0.2, -0.4, 0.1, 1.5, -0.1, 0.35, 0.3;
  robot.set_joints(q);
  const math::Pose X_WO =
      robot.flange_pose() *
      math::make_pose(math::exp_rotation({0.1, 0.2, 0.05}), {-0.02, -0.02, 0.25});
  object::PlantOptions options;
  options.size = {0.04, 0.04, 0.06};
  options.elements = {1, 1, 2};
  options.mass_damping = 0;
  std::vector<Fingertip> tips;
  for (const std::string& link : fingertips_of(robot)) {
    tips.emplace_back();
    tips.back().link = link;
    options.fingertips.push_back(tips.back().sphere);
  }
  object::HyperelasticPlant plant(options);
  const FingertipCoupling coupling(tips, robot, X_WO);
  HandControl hand(robot);
  hand_command_t close{};
  close.action = hand_command_t::CLOSE;
  ASSERT_TRUE(hand.accept(close));

  coupling.move(robot, plant);
  Vector3d given = Vector3d::Zero(), given_about_origin = Vector3d::Zero();  // of O, in O
  double most = 0, most_about_origin = 0;
  int touching = 0;
  for (int i = 0; i < 500; ++i) {
    std::vector<Vector3d> before;
    for (int tip = 0; tip < coupling.tip_count(); ++tip)
      before.push_back(plant.fingertip(tip).centre());
    hand.step(i, robot);
    coupling.load(plant, robot);
    robot.step(1e-3);
    coupling.move(robot, plant);
    plant.step(1e-3);
    coupling.load(plant, robot);
    for (int tip = 0; tip < coupling.tip_count(); ++tip) {
      const math::Wrench on_link = robot.link_load(coupling.link(tip));
      const Vector3d force = X_WO.linear().transpose() * on_link.force;
      const Vector3d torque = X_WO.linear().transpose() * on_link.torque;
      // The centre moves while the wrench about it is averaged.
      const Vector3d centre = 0.5 * (before[tip] + plant.fingertip(tip).centre());
      given -= 1e-3 * force;
      given_about_origin -= 1e-3 * (torque + centre.cross(force));
      touching += force.norm() > 0;
    }
    most = std::max(most, object::linear_momentum(plant).norm());
    most_about_origin = std::max(most_about_origin, object::angular_momentum(plant).norm());
    ASSERT_LT((object::linear_momentum(plant) - given).norm(), 1e-9 * (most + 1e-6)) << i;
    ASSERT_LT((object::angular_momentum(plant) - given_about_origin).norm(),
              0.01 * (most_about_origin + 1e-6))
        << i;
  }
  EXPECT_GT(touching, 100);
  EXPECT_GT(most, 1e-5);
}

TEST(Fingertips, ReactiveGraspEndsInItsBand) {
  Stage stage(kTactile, {});
  stage.run(0.9);
  EXPECT_EQ(stage.sent<hand_state_t>("HAND_STATE").back().grasp, hand_state_t::GRASP_NONE);
  EXPECT_EQ(stage.sent<truth_touch_t>("TRUTH_TOUCH").back().contact[4], truth_touch_t::NONE);
  stage.run(kHeld - 0.9);
  stage.messages.clear();
  stage.run(1);
  EXPECT_EQ(stage.sent<hand_state_t>("HAND_STATE").back().grasp, hand_state_t::GRASP_HOLDING);
  const auto touches = stage.sent<truth_touch_t>("TRUTH_TOUCH");
  ASSERT_EQ(touches.size(), 100u);
  for (const truth_touch_t& touch : touches) {
    EXPECT_EQ(touch.fingertip_count, 5);
    EXPECT_EQ(touch.contact[kFree], truth_touch_t::NONE);
    for (const int finger : kTouching) {
      EXPECT_EQ(touch.contact[finger], truth_touch_t::STICKING) << finger;
      const double force = Eigen::Map<const Vector3d>(touch.force[finger]).norm();
      EXPECT_GE(force, 0.1) << finger;
      EXPECT_LE(force, 1) << finger;
    }
  }
  EXPECT_GT(touches.back().force[1][2], 0.1);   // from below
  EXPECT_LT(touches.back().force[4][2], -0.1);  // from above
}

TEST(Fingertips, MessagesReportTheTouchWithTheirDeviations) {
  Stage stage(kTactile, {});
  stage.run(kHeld);
  const Simulation& s = stage.simulation;
  for (int finger = 0; finger < 5; ++finger) {
    const auto messages = stage.sent<fingertip_t>("FINGERTIP_" + std::to_string(finger));
    ASSERT_NEAR(messages.size(), 100 * kHeld, 2);
    const fingertip_t& last = messages.back();
    EXPECT_EQ(last.place_deviation, 3e-4);
    EXPECT_EQ(last.force_deviation, 0.02);
    const bool touches = std::find(kTouching.begin(), kTouching.end(), finger) != kTouching.end();
    EXPECT_EQ(last.contact, touches ? 1 : 0) << finger;
    if (!touches) continue;
    const object::FingertipTouch& touch = s.plant().fingertip(finger).touch();
    const math::Pose X_TO = tip_in_world(s, finger).inverse() * s.scene().X_WO;
    const Vector3d force = -(X_TO.linear() * touch.force), place = X_TO * touch.point;
    const Eigen::Map<const Vector3d> found(last.force), at(last.place), normal(last.normal);
    EXPECT_LT((found - force).norm(), 5 * 0.02 + 0.05 * force.norm()) << finger;
    EXPECT_LT((at - sensing::project_on_skin(place)).norm(), 5 * 3e-4) << finger;
    EXPECT_NEAR(normal.norm(), 1, 1e-12);
    EXPECT_GT(normal.dot(force), 0.5 * force.norm()) << "it presses: " << finger;
    EXPECT_NEAR(last.area, touch.area, 0.2 * touch.area) << finger;
  }
}

TEST(Fingertips, BiotacMessagesShowWhereTheTouchIs) {
  Stage stage(kTactile, {});
  stage.run(kHeld);
  const Simulation& s = stage.simulation;
  for (int finger = 0; finger < 5; ++finger) {
    const auto messages = stage.sent<biotac_t>("BIOTAC_" + std::to_string(finger));
    ASSERT_NEAR(messages.size(), 100 * kHeld, 2);
    sensing::ElectrodeVector counts;
    for (int e = 0; e < sensing::kElectrodeCount; ++e)
      counts(e) = messages.back().electrodes[e] - messages[80].electrodes[e];
    const int pressure = messages.back().pdc - messages[80].pdc;
    if (std::find(kTouching.begin(), kTouching.end(), finger) == kTouching.end()) {
      EXPECT_LT(std::abs(pressure), 10) << finger;
      EXPECT_LT(counts.cwiseAbs().maxCoeff(), 15) << finger;
      continue;
    }
    EXPECT_GT(pressure, 20) << finger;
    const Vector3d point = tip_in_world(s, finger).inverse() *
                           (s.scene().X_WO * s.plant().fingertip(finger).touch().point);
    // Currents are diverted also far from the contact, but most next to it.
    int strongest = 0;
    counts.maxCoeff(&strongest);
    EXPECT_LT((sensing::electrode_positions().col(strongest) - point).norm(), 5e-3) << finger;
  }
}

TEST(Fingertips, HandCommandOpensWhatThePlanClosed) {
  Stage stage(kTactile, {});
  bus::TypedPublisher<hand_command_t> commands(*stage.daemon, "HAND_COMMAND");
  stage.run(2);
  hand_command_t open{};
  open.seq = 1;
  open.session = 5;
  open.action = hand_command_t::OPEN;
  commands.publish(open);
  stage.run(1.5);
  EXPECT_EQ(stage.sent<hand_state_t>("HAND_STATE").back().grasp, hand_state_t::GRASP_NONE);
  const truth_touch_t touch = stage.sent<truth_touch_t>("TRUTH_TOUCH").back();
  for (const int finger : kTouching) EXPECT_EQ(touch.contact[finger], truth_touch_t::NONE);
}

TEST(Fingertips, HandSlidesOffWhatItDoesNotHoldFirmly) {
  Stage stage(kTactile, {"motion.start_delay=2", "motion.poses.0.translation=[-0.04, 0, 0]",
                         "motion.poses.0.move=1", "fingertips.1.friction=0.05",
                         "fingertips.2.friction=0.05", "fingertips.4.friction=0.05"});
  stage.run(2.6);
  EXPECT_EQ(stage.sent<hand_state_t>("HAND_STATE").back().grasp, hand_state_t::GRASP_SLIPPING);
  const truth_touch_t touch = stage.sent<truth_touch_t>("TRUTH_TOUCH").back();
  for (const int finger : kTouching) {
    EXPECT_EQ(touch.contact[finger], truth_touch_t::SLIPPING) << finger;
    EXPECT_GT(touch.slipped[finger], 5e-3) << finger;
  }
}

TEST(Fingertips, PadsThatSlipSaySo) {
  Stage stage(kSixPoses, coarse({"object.pads.grip=0.2", "object.pads.friction=0.2"}));
  stage.run(0.5);
  EXPECT_EQ(stage.sent<hand_state_t>("HAND_STATE").back().grasp, hand_state_t::GRASP_HOLDING);
  stage.run(1.6);
  EXPECT_EQ(stage.sent<hand_state_t>("HAND_STATE").back().grasp, hand_state_t::GRASP_SLIPPING);
}

TEST(Fingertips, TwoRunsAreEqualToTheBit) {
  const auto run = [] {
    Stage stage(kTactile, {});
    stage.run(2);
    return stage.messages;
  };
  const auto first = run(), again = run();
  ASSERT_EQ(first.size(), again.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    ASSERT_EQ(first[i].channel, again[i].channel) << i;
    ASSERT_EQ(first[i].data, again[i].data) << i << " " << first[i].channel;
  }
}

TEST(Fingertips, ThoseThatTouchNothingChangeNothingElse) {
  const auto run = [](const std::vector<std::string>& overrides) {
    Stage stage(kSixPoses, coarse(overrides));
    stage.run(2);
    std::vector<bus::Published> kept;
    for (const bus::Published& m : stage.messages)
      if (m.channel.rfind("BIOTAC_", 0) != 0 && m.channel.rfind("FINGERTIP_", 0) != 0 &&
          m.channel != "TRUTH_TOUCH")
        kept.push_back(m);
    EXPECT_EQ(kept.size() == stage.messages.size(), overrides.empty());
    return kept;
  };
  const auto without = run({});
  const auto with =
      run({"fingertips=[{link: ff_tip, radius: 0.002}, {link: th_tip, radius: 0.002}]"});
  ASSERT_EQ(without.size(), with.size());
  for (std::size_t i = 0; i < with.size(); ++i) {
    ASSERT_EQ(without[i].channel, with[i].channel) << i;
    ASSERT_EQ(without[i].data, with[i].data) << i << " " << with[i].channel;
  }
}

TEST(Fingertips, FrameInTheLinkMovesTipAndTouch) {
  Stage stage(kTactile, {"fingertips.1.frame={position: [0, 0, 0.002], rpy_deg: [0, 0, 90]}"});
  stage.run(0.1);
  const Simulation& s = stage.simulation;
  const math::Pose X_WT =
      tip_in_world(s, 1) * math::make_pose(math::exp_rotation({0, 0, M_PI / 2}), {0, 0, 2e-3});
  EXPECT_LT((s.scene().X_WO * s.plant().fingertip(1).centre() - X_WT.translation()).norm(), 1e-12);
  const hand_state_t hand = stage.sent<hand_state_t>("HAND_STATE").back();
  const math::Pose X_ET = s.robot().flange_pose().inverse() * X_WT;
  EXPECT_LT((Vector3d(hand.fingertip_position[1]) - X_ET.translation()).norm(), 1e-3);
  EXPECT_TRUE(math::rotation_from_wxyz(hand.fingertip_quaternion[1]).isApprox(X_ET.linear(), 1e-3));
}

TEST(Fingertips, LinksThatAreNoneAreRefused) {
  const auto refusal = [](const std::string& override) -> std::string {
    try {
      Stage stage(kTactile, {override});
    } catch (const config::Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(refusal("fingertips.0.link=flange").find("no fingertip named flange"),
            std::string::npos);
  EXPECT_NE(refusal("fingertips.0.link=th_tip").find("twice"), std::string::npos);
  EXPECT_NE(refusal("fingertips.0.radius=0").find("fingertips.0.radius"), std::string::npos);
  EXPECT_NE(refusal("robot.initial_hand.ff_j9=0.1").find("no joint named ff_j9"),
            std::string::npos);
  EXPECT_NE(refusal("hand=[{at: 2, action: close}, {at: 1, action: open}]").find("at"),
            std::string::npos);
  EXPECT_NE(refusal("hand=[{at: 2, action: squeeze}]").find("action"), std::string::npos);
}

}  // namespace
}  // namespace palpate::scenes
