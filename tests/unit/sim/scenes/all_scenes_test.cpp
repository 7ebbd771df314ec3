// Every scene file of the tree: it loads, runs, and the arm can execute its motion.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "tests/unit/sim/scenes/stage.hpp"

namespace palpate::scenes {
namespace {

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(PALPATE_SOURCE_DIR "/sim/scenes"))
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::string path_of(const std::string& name) {
  return PALPATE_SOURCE_DIR "/sim/scenes/" + name + ".yaml";
}

class EveryScene : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryScene, RestsInTheHandAndRuns) {
  Stage stage(path_of(GetParam()), {});
  const Simulation& s = stage.simulation;
  const Scene& scene = s.scene();
  for (std::size_t i = 0; i < scene.plant.grasps.size(); ++i) {
    // Held as specified in the file: the hand is at the patch, its axes along those of O.
    const math::Pose X_OG = s.arm(static_cast<int>(i)).grasp_in_object();
    EXPECT_LT(math::log_rotation(X_OG.linear()).norm(), 1e-6);
    const object::Box& patch = scene.plant.grasps[i].patch;
    if (!s.object().grasped(static_cast<int>(i))) continue;  // it does not hold it yet
    EXPECT_TRUE((X_OG.translation().array() > patch.lower.array()).all()) << X_OG.translation();
    EXPECT_TRUE((X_OG.translation().array() < patch.upper.array()).all()) << X_OG.translation();
  }
  const Eigen::Matrix3Xd before = s.object().positions();
  stage.run(0.01);
  EXPECT_NEAR(stage.sent<ft_wrench_t>("FT_WRENCH").size(), 10, 1);
  EXPECT_TRUE(s.object().positions().allFinite());
  EXPECT_LT((s.object().positions() - before).cwiseAbs().maxCoeff(), 1e-4);
}

INSTANTIATE_TEST_SUITE_P(Scene, EveryScene, ::testing::ValuesIn(scene_names()),
                         [](const auto& tested) { return tested.param; });

/// Scenes with a scripted motion; those with the thesis' moduli and with another kind of object
/// repeat that of another.
std::vector<std::string> moving_scenes() {
  std::vector<std::string> names;
  for (const std::string& name : scene_names()) {
    const bool repeats =
        name.find("_thesis") != std::string::npos || name.find("_dart_soft") != std::string::npos;
    if (!repeats && read_scene(config::Node::load_file(path_of(name))).motion)
      names.push_back(name);
  }
  return names;
}

/// The object with few elements: sufficient for its load on the arm.
std::vector<std::string> coarse_object(const std::string& name) {
  static const std::map<std::string, std::string> kElements{{"bar_regrasp", "[5, 1, 2]"},
                                                            {"bar_soft_tactile", "[5, 1, 1]"},
                                                            {"cube_hard_tactile", "[1, 1, 1]"},
                                                            {"cube_regrasp", "[1, 1, 4]"},
                                                            {"sponge_medium_tactile", "[2, 1, 1]"}};
  const auto found = kElements.find(name);
  if (found != kElements.end()) return {"object.elements=" + found->second};
  if (name.find("bar_long") == 0) return coarse();
  if (name.find("bar_two") == 0) return {"object.elements=[10, 1, 1]", "object.pads.stiffness=1e4"};
  if (name.find("block") != 0) return {};
  return {"object.elements=[4, 1, 4]",
          "object.grasp_box={lower: [0.3, 0, 0.1], upper: [0.4, 0.06, 0.3]}",
          "object.pads.stiffness=1e4"};
}

class MovingScene : public ::testing::TestWithParam<std::string> {};

TEST_P(MovingScene, KeepsTheArmWithinItsLimitsAndOnItsWay) {
  Stage stage(path_of(GetParam()), coarse_object(GetParam()));
  Simulation& s = stage.simulation;
  const MotionPlan& plan = *s.scene().motion;
  double room = 10, speed = 0, torque = 0, distance = 0, angle = 0;
  while (s.time() < plan.duration()) {
    s.step();
    for (int i = 0; i < s.arm_count(); ++i) {
      const Arm& arm = s.arm(i);
      const robot::Robot& robot = arm.robot();
      const robot::JointLimits& limits = robot.limits();
      const Eigen::ArrayXd q = robot.joint_positions();
      room = std::min(
          {room, (limits.upper.array() - q).minCoeff(), (q - limits.lower.array()).minCoeff()});
      speed = std::max(
          speed, (robot.joint_velocities().array() / limits.velocity.array()).abs().maxCoeff());
      torque = std::max(torque,
                        (robot.joint_torques().array() / limits.torque.array()).abs().maxCoeff());
      const math::Pose X = arm.grasp_in_object(), target = arm.grasp_target(s.time());
      distance = std::max(distance, (X.translation() - target.translation()).norm());
      angle = std::max(angle, math::log_rotation(X.linear() * target.linear().transpose()).norm());
    }
  }
  EXPECT_GT(room, 0.1) << "rad to the nearest joint limit";
  EXPECT_LT(speed, 0.8) << "of the joint speed limit";
  EXPECT_LT(torque, 0.8) << "of the joint torque limit";
  for (int i = 0; i < s.arm_count(); ++i)
    EXPECT_EQ(s.arm(i).robot().torque_limited_steps(), 0) << i;
  EXPECT_LT(distance, 1.5e-3) << "m from the plan";
  EXPECT_LT(angle, 5e-3) << "rad from the plan";
  EXPECT_EQ(s.object().grasped(0), !s.scene().plant.grasps.empty());
}

INSTANTIATE_TEST_SUITE_P(Scene, MovingScene, ::testing::ValuesIn(moving_scenes()),
                         [](const auto& tested) { return tested.param; });

}  // namespace
}  // namespace palpate::scenes
