#include "sim/scenes/scene.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/scratch_folder.hpp"
#include "tests/unit/sim/scenes/stage.hpp"

namespace palpate::scenes {
namespace {

Scene read(const std::string& file, const std::vector<std::string>& overrides = {}) {
  return read_scene(config::Node::load_file(file, overrides));
}

std::string refusal(const std::vector<std::string>& overrides) {
  try {
    read(kSixPoses, overrides);
  } catch (const config::Error& error) {
    return error.what();
  }
  return "";
}

TEST(Scene, SixPosesAndControlShareArmAndObject) {
  const Scene poses = read(kSixPoses), control = read(kControl);
  ASSERT_TRUE(poses.motion);
  EXPECT_EQ(poses.motion->legs().size(), 6u);
  EXPECT_EQ(poses.motion->start_delay(), 1);
  EXPECT_FALSE(control.motion);
  EXPECT_EQ(poses.initial_joints, control.initial_joints);
  EXPECT_TRUE(poses.X_WO.isApprox(control.X_WO));
  EXPECT_TRUE(poses.X_EG.isApprox(control.X_EG));
  EXPECT_EQ(poses.plant.size, control.plant.size);
  EXPECT_EQ(poses.plant.young_modulus, 30e3);
  EXPECT_EQ(poses.plant.grasps[0].stiffness, control.plant.grasps[0].stiffness);
  EXPECT_TRUE(poses.object_gravity);
  EXPECT_EQ(poses.bus.control, BusUrls().control);
  EXPECT_EQ(poses.bus.housekeeping, BusUrls().housekeeping);
  EXPECT_EQ(poses.bus.pictures, BusUrls().pictures);
}

// The fitted material: the output of palpate-fit overrides the scene's material.
TEST(Scene, TakesTheMaterialThatWasFitted) {
  const support::ScratchFolder folder;
  const std::string file = (folder.path() / "material.yaml").string();
  std::ofstream(file) << "material: {model: neo_hookean, young_modulus: 41e3, poisson_ratio: 0.25,"
                         " mass_damping: 1.5, stiffness_damping: 1e-3}\n"
                         "corotational: {young_modulus: 39e3, poisson_ratio: 0.26}\n";
  const Scene s = read(kSixPoses, {"object.material_file=" + file});
  EXPECT_EQ(s.plant.young_modulus, 41e3);
  EXPECT_EQ(s.plant.poisson_ratio, 0.25);
  EXPECT_EQ(s.plant.density, 26);
  EXPECT_EQ(s.plant.mass_damping, 2);  // the scene's own
  EXPECT_NEAR(s.plant.viscosity, 1e-3 * 41e3 / (2 * 1.25), 1e-9);
  std::ofstream(file) << "material: {model: ogden_1, young_modulus: 41e3, poisson_ratio: 0.25}\n";
  EXPECT_NE(refusal({"object.material_file=" + file}).find("neo_hookean"), std::string::npos);
  std::ofstream(file) << "seed: 1\n";
  EXPECT_NE(refusal({"object.material_file=" + file}).find("palpate-fit"), std::string::npos);
}

TEST(Scene, OverridesReachTheModel) {
  const Scene s = read(kSixPoses, {"object.pads.stiffness=3e3", "seed=7",
                                   "sensors.force_torque.bias=[0.05, 0, 0, 0, 0, 0]",
                                   "motion.poses.5.move=4", "object.gravity=false"});
  EXPECT_EQ(s.plant.grasps[0].stiffness, 3e3);
  EXPECT_EQ(s.seed, 7u);
  EXPECT_EQ(s.sensors.force_torque.bias(0), 0.05);
  EXPECT_EQ(s.motion->legs()[5].move, 4);
  EXPECT_FALSE(s.object_gravity);
}

TEST(Scene, TactileOnesAreTheThesisObjectsOfPlausibleFoam) {
  struct Case {
    const char* name;
    Eigen::Vector3d size;  // m
    double mass;           // kg
  };
  for (const Case& c : {Case{"cube_hard", {0.06, 0.06, 0.06}, 9.72e-3},
                        Case{"sponge_medium", {0.08, 0.05, 0.02}, 2.40e-3},
                        Case{"bar_soft", {0.2, 0.04, 0.04}, 8.32e-3}}) {
    const std::string file =
        std::string(PALPATE_SOURCE_DIR "/sim/scenes/") + c.name + "_tactile.yaml";
    const Scene s = read(file);
    EXPECT_EQ(s.plant.size, c.size) << c.name;
    EXPECT_NEAR(s.plant.density * s.plant.size.prod(), c.mass, 1e-6) << c.name;
    EXPECT_GE(s.plant.young_modulus, 30e3) << c.name;
    EXPECT_LE(s.plant.young_modulus, 60e3) << c.name;
    EXPECT_EQ(s.plant.poisson_ratio, 0.15) << c.name;
    EXPECT_TRUE(s.plant.grasps.empty()) << c.name;
    EXPECT_EQ(s.fingertips.size(), 5u) << c.name;
    EXPECT_EQ(s.fingertips.size(), s.plant.fingertips.size()) << c.name;
    ASSERT_TRUE(s.motion) << c.name;
    EXPECT_EQ(s.motion->legs().size(), 3u) << c.name;
    EXPECT_EQ(read(file, {"object.material.young_modulus=3000"}).plant.young_modulus, 3000);
  }
}

TEST(Scene, HandPlanIsRead) {
  const Scene s = read(kControl, {"hand=[{at: 1, action: close}, {at: 2, action: hold, force: 3}, "
                                  "{at: 4, action: open}]"});
  ASSERT_EQ(s.hand.size(), 3u);
  EXPECT_EQ(s.hand[0].command.action, hand_command_t::CLOSE);
  EXPECT_EQ(s.hand[1].command.action, hand_command_t::HOLD);
  EXPECT_EQ(s.hand[1].command.force, 3);
  EXPECT_EQ(s.hand[2].at, 4);
  EXPECT_EQ(s.hand[2].command.action, hand_command_t::OPEN);
  EXPECT_TRUE(read(kControl).hand.empty());
}

TEST(Scene, MaterialMemoryAndGripReachThePlant) {
  const Scene s = read(
      kSixPoses, {"object.material.maxwell=[{relative_modulus: 0.5, relaxation_time: 0.2}]",
                  "object.material.yield={stress: 500, hardening: 100}",
                  "object.material.regions=[{box: {lower: [0, 0, 0], upper: [0.1, 1, 1]}, "
                  "young_modulus: 6e4}]",
                  "object.pads.grip=20", "object.pads.friction=0.6", "object.pads.pinch_axis=y"});
  ASSERT_EQ(s.plant.maxwell.size(), 1u);
  EXPECT_EQ(s.plant.maxwell[0].relative_modulus, 0.5);
  EXPECT_EQ(s.plant.maxwell[0].relaxation_time, 0.2);
  ASSERT_TRUE(s.plant.yield);
  EXPECT_EQ(s.plant.yield->stress, 500);
  EXPECT_EQ(s.plant.yield->hardening, 100);
  ASSERT_EQ(s.plant.regions.size(), 1u);
  EXPECT_EQ(s.plant.regions[0].young_modulus, 6e4);
  EXPECT_EQ(s.plant.regions[0].box.upper.x(), 0.1);
  ASSERT_EQ(s.plant.grasps.size(), 1u);
  EXPECT_EQ(s.plant.grasps[0].grip, 20);
  EXPECT_EQ(s.plant.grasps[0].friction, 0.6);
  EXPECT_EQ(s.plant.grasps[0].pinch_axis, 1);
}

TEST(Scene, UnmodelledPropertiesOfTheObjectReachThePlant) {
  const Scene s =
      read(kSixPoses,
           {"object.clamp_pads={stiffness: 700, damping: 3}",
            "object.stiffness_field={deviation: 0.2, length: 0.05, seed: 9}",
            "object.material.regions=[{box: {lower: [0, 0, 0], upper: [0.25, 1, 1]}, factor: 3}]"});
  ASSERT_TRUE(s.plant.clamp_pads);
  EXPECT_EQ(s.plant.clamp_pads->stiffness, 700);
  EXPECT_EQ(s.plant.clamp_pads->damping, 3);
  EXPECT_EQ(s.plant.stiffness_field.deviation, 0.2);
  EXPECT_EQ(s.plant.stiffness_field.length, 0.05);
  EXPECT_EQ(s.plant.stiffness_field.seed, 9u);
  ASSERT_EQ(s.plant.regions.size(), 1u);
  EXPECT_EQ(s.plant.regions[0].young_modulus, 9e4);
  const Scene plain = read(kSixPoses);
  EXPECT_FALSE(plain.plant.clamp_pads);
  EXPECT_EQ(plain.plant.stiffness_field.deviation, 0);
  EXPECT_NE(refusal({"object.material.regions=[{box: {lower: [0, 0, 0], upper: [1, 1, 1]}, factor: "
                     "3, young_modulus: 1e4}]"})
                .find("factor"),
            std::string::npos);
}

TEST(Scene, WrongScenesAreRefusedWithTheirKey) {
  for (const char* wrong :
       {"object.clamp_pads.stiffness=0", "object.clamp_pads.rate=1",
        "object.stiffness_field.deviation=-1", "object.stiffness_field.deviation=2",
        "object.stiffness_field={deviation: 0.1, length: 0}", "object.sizes=3",
        "object.size=[0.5, 0, 0.06]", "object.elements=[1.5, 1, 1]",
        "object.material.poisson_ratio=0.5", "object.pads.stiffness=-1", "object.pads.pinch_axis=w",
        "object.material.maxwell=[{relative_modulus: 0, relaxation_time: 1}]", "robot.speed=1",
        "sensors.force_torque.rate=0", "sensors.force_torque.bias=[1]", "motion.poses.0.move=0",
        "motion.poses=[]", "object.pose={position: [0, 0, 0], quaternion: [1, 1, 0, 0]}"}) {
    const std::string key = std::string(wrong).substr(0, std::string(wrong).find('='));
    const std::string last = key.substr(key.rfind('.') + 1);
    EXPECT_NE(refusal({wrong}).find(last), std::string::npos) << wrong << ": " << refusal({wrong});
  }
  EXPECT_EQ(refusal({}), "");
}

TEST(Scene, RobotThatCannotBeLoadedIsAConfigurationError) {
  EXPECT_THROW(Stage(kControl, {"robot.urdf=no_such.urdf"}), config::Error);
  EXPECT_THROW(Stage(kControl, {"robot.frames.imu=no_such_link"}), config::Error);
  EXPECT_THROW(Stage(kControl, {"robot.initial_joints=[0, 0, 0]"}), config::Error);
  EXPECT_THROW(Stage(kControl, {"robot.initial_joints=[0, 2.5, 0, 0, 0, 0, 0]"}), config::Error);
  EXPECT_THROW(Stage(kControl, {"object.grasp_box.lower=[0.6, 0, 0]"}), config::Error);
}

}  // namespace
}  // namespace palpate::scenes
