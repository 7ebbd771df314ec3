// Limits of the controller as configured.

#include <gtest/gtest.h>

#include "rt/pipeline/pipeline.hpp"
#include "tests/support/pipeline_cycles.hpp"

namespace palpate::pipeline {
namespace {

std::string error_of(const std::vector<std::string>& overrides) {
  try {
    const config::Node root = config::Node::load_file(
        PALPATE_SOURCE_DIR "/rt/config/examples/bar_long_soft_limits.yaml", overrides);
    const Pipeline pipeline(root, 1e-3);
  } catch (const config::Error& error) {
    return error.what();
  }
  return "";
}

const char* const kUrdf = "robot.urdf=" PALPATE_SOURCE_DIR "/sim/robot/lwr_hand.urdf";
const char* const kJoints = "control.command=joint_velocity";

TEST(ControlLimits, OfStressAndStretchHaveRanges) {
  EXPECT_NE(error_of({"control.limits.stress=0"}).find("control.limits.stress"), std::string::npos);
  EXPECT_NE(error_of({"control.limits.stretch=0.9"}).find("control.limits.stretch"),
            std::string::npos);
  EXPECT_EQ(error_of({"control.limits={stress: 100, stretch: 1.01}"}), "");
}

TEST(ControlLimits, OfJointsNeedTheArmAndTheLaw) {
  EXPECT_EQ(error_of({kUrdf, kJoints}), "");
  EXPECT_NE(error_of({kJoints}).find("section robot"), std::string::npos);
  EXPECT_NE(error_of({kUrdf, kJoints,
                      "control={provider: fem, law: proportional_twist, command: "
                      "joint_velocity}"})
                .find("needs the law quadratic_program"),
            std::string::npos);
  EXPECT_NE(error_of({kUrdf, kJoints, "robot.flange=nowhere"}).find("nowhere"), std::string::npos);
  EXPECT_NE(error_of({"robot.urdf=/nowhere.urdf"}).find("cannot be opened"), std::string::npos);
  EXPECT_NE(error_of({kUrdf, kJoints, "robot.joint_upper_deg=[1, 2, 3]"}).find("joint_upper_deg"),
            std::string::npos);
  EXPECT_NE(error_of({kUrdf, "robot.joint_margin_deg=89",
                      "robot.joint_upper_deg=[10, 10, 10, 10, 10, 10, 10]",
                      "robot.joint_lower_deg=[-10, -10, -10, -10, -10, -10, -10]"})
                .find("lower limit"),
            std::string::npos);
}

// A robot that differs from the one of the URDF file is not moved.
TEST(ControlLimits, JointsOfAnotherArmAreNotCommanded) {
  const config::Node root = config::Node::load_file(
      PALPATE_SOURCE_DIR "/rt/config/examples/bar_long_soft_limits.yaml", {kUrdf, kJoints});
  Pipeline pipeline(root, 1e-3);
  sensing::Signals signals = support::at_rest(pipeline);
  signals.robot.latest.joint_count = 7;  // all at zero: the flange is elsewhere
  const char* reason = "";
  pipeline.start();
  support::run(pipeline, signals, 50);
  Eigen::Vector3d target = pipeline.feature_state().value;
  target.z() += 0.02;
  ASSERT_TRUE(pipeline.set_target(1, "point", nullptr, 0, target.data(), 3, reason)) << reason;
  support::run(pipeline, signals, 50);
  EXPECT_STREQ(pipeline.condition().reason, "the robot's joints are not those of its model");
  EXPECT_EQ(pipeline.gate_output(0).joint_velocity.size(), 7);
  EXPECT_EQ(pipeline.gate_output(0).joint_velocity.norm(), 0);
}

}  // namespace
}  // namespace palpate::pipeline
