#include "tools/bridge/drake/settings.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

namespace palpate::drake_bridge {
namespace {

const std::string kRobot =
    "robot: {arm: iiwa, urdf: " + std::string(PALPATE_SOURCE_DIR) + "/sim/robot/lwr_hand.urdf";

std::string error_of(const std::string& text) {
  try {
    read_settings(config::Node::from_text(text));
  } catch (const config::Error& error) {
    return error.what();
  }
  return "";
}

TEST(DrakeSettings, HaveDefaults) {
  const Settings settings = read_settings(config::Node::from_text(kRobot + "}"));
  EXPECT_EQ(settings.status, "IIWA_STATUS");
  EXPECT_EQ(settings.command, "IIWA_COMMAND");
  EXPECT_EQ(settings.chain.joint_count(), 7);
  EXPECT_EQ(settings.drake, settings.control);
  EXPECT_FALSE(settings.gripper);
  EXPECT_FALSE(settings.shape);
}

TEST(DrakeSettings, ErrorsNameTheKey) {
  EXPECT_NE(error_of("robot: {arm: ur5, urdf: a.urdf}").find("iiwa, panda"), std::string::npos);
  EXPECT_NE(error_of("robot: {arm: iiwa, urdf: no_such.urdf}").find("robot.urdf"),
            std::string::npos);
  EXPECT_NE(error_of(kRobot + ", stale_ms: 400}").find("robot.stale_ms"), std::string::npos);
  EXPECT_NE(error_of(kRobot + "}\nbus: {drake: tcp}").find("bus.drake"), std::string::npos);
  EXPECT_NE(error_of(kRobot + "}\nguard: {speed: 1}").find("guard.speed"), std::string::npos);
  EXPECT_EQ(error_of(kRobot + "}\ngripper: {force: 20}\nshape: {rate: 30}"), "");
}

/// Every key is in the page.
TEST(DrakeSettings, AreDocumented) {
  std::ifstream file(std::string(PALPATE_SOURCE_DIR) + "/docs/robots/drake.md");
  std::stringstream page;
  page << file.rdbuf();
  const config::DeclarationList list;
  read_settings(config::Node::from_text(kRobot + "}\ngripper: {}\nshape: {}"));
  EXPECT_GT(list.all().size(), 25u);
  for (const config::Declaration& key : list.all())
    EXPECT_NE(page.str().find("`" + key.name + "`"), std::string::npos) << key.path << key.name;
}

}  // namespace
}  // namespace palpate::drake_bridge
