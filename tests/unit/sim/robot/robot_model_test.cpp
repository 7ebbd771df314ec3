#include "sim/robot/robot_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "tests/unit/sim/robot/arm.hpp"

namespace palpate::robot {
namespace {

std::string one_joint(const std::string& limit) {
  return "<robot name='r'><link name='base'/><link name='flange'><inertial><mass value='1'/>"
         "<inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>"
         "<link name='sensor'/><link name='imu'/>"
         "<joint name='a' type='revolute'><parent link='base'/><child link='flange'/>" +
         limit +
         "</joint><joint name='b' type='fixed'><parent link='flange'/><child "
         "link='sensor'/></joint>"
         "<joint name='c' type='fixed'><parent link='flange'/><child link='imu'/></joint></robot>";
}

std::string message_of(const std::string& text) {
  try {
    Robot robot(parse_model(text, "some.urdf"), RobotOptions());
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(RobotModel, ReadsTheArmAndItsPrimitives) {
  const RobotModel model = load_model(kArmUrdf);
  EXPECT_EQ(model.link_count, 1 + 7 + 4 + 1 + 25);
  EXPECT_EQ(model.joint_count, model.link_count - 1);
  EXPECT_GT(model.visuals.size(), 20u);
  for (const VisualShape& v : model.visuals) {
    EXPECT_GT(v.size.x(), 0) << v.link;
    EXPECT_TRUE(v.colour.minCoeff() >= 0 && v.colour.maxCoeff() <= 1) << v.link;
  }
  const auto first = std::find_if(model.visuals.begin(), model.visuals.end(),
                                  [](const VisualShape& v) { return v.link == "base_link"; });
  ASSERT_NE(first, model.visuals.end());
  EXPECT_EQ(first->kind, ShapeKind::kCylinder);
  EXPECT_NEAR(first->X_LV.translation().z(), 0.051, 1e-12);
}

TEST(RobotModel, RefusesWhatCannotBeReadInFull) {
  EXPECT_THROW(load_model("no_such_file.urdf"), std::invalid_argument);
  EXPECT_NE(message_of("<robot name='r'><link").find("well-formed"), std::string::npos);
  EXPECT_NE(message_of("<sdf/>").find("no <robot>"), std::string::npos);
  EXPECT_NE(message_of("<robot name='r'><xacro:foo/></robot>").find("expand"), std::string::npos);
  // urdfdom reads this one without an error, omitting a link.
  EXPECT_NE(message_of("<robot name='r'><link name='a'/><link/></robot>"), "");
  EXPECT_EQ(message_of("<robot name='r'><link/></robot>").find("some.urdf"), 0u);
}

TEST(RobotModel, DrivenJointsNeedLimits) {
  const std::string good =
      "<axis xyz='0 0 1'/><limit lower='-1' upper='1' velocity='2' effort='3'/>";
  EXPECT_EQ(message_of(one_joint(good)), "");
  const std::string no_effort =
      "<axis xyz='0 0 1'/><limit lower='-1' upper='1' velocity='2' effort='0'/>";
  EXPECT_NE(message_of(one_joint(no_effort)).find("effort"), std::string::npos);
}

TEST(RobotModel, MissingFrameIsNamed) {
  RobotOptions options;
  options.frames.sensor = "wrist_sensor";
  try {
    Robot robot(load_model(kArmUrdf), options);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("wrist_sensor"), std::string::npos);
  }
}

}  // namespace
}  // namespace palpate::robot
