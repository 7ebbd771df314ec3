#include "tools/bridge/ros2/settings.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

namespace palpate::ros2_bridge {
namespace {

std::string example() {
  return std::string(PALPATE_SOURCE_DIR) + "/tools/bridge/ros2/examples/arm.yaml";
}

Settings settings_with(const std::vector<std::string>& overrides) {
  return read_settings(config::Node::load_file(example(), overrides));
}

std::string error_of(const std::vector<std::string>& overrides) {
  try {
    settings_with(overrides);
  } catch (const config::Error& error) {
    return error.what();
  }
  return "";
}

TEST(Ros2Settings, TheExampleConnectsEverything) {
  const Settings settings = settings_with({});
  ASSERT_TRUE(settings.robot && settings.wrench && settings.cloud && settings.shape &&
              settings.target);
  EXPECT_EQ(settings.robot->arm.commands, "forward_velocity_controller/commands");
  EXPECT_EQ(settings.imu, "imu/data");
  EXPECT_EQ(settings.services, "palpate");
  EXPECT_NEAR(settings.shape->X_WO.translation().x(), 1.36, 1e-12);
  EXPECT_EQ(settings.cloud->url, settings.control);
  EXPECT_NEAR(settings.robot->guard.linear_speed, 0.1, 1e-12);
}

TEST(Ros2Settings, NothingIsConnectedThatIsNotNamed) {
  const Settings settings = read_settings(config::Node::from_text("{imu: /imu/data}"));
  EXPECT_FALSE(settings.robot || settings.wrench || settings.cloud || settings.shape ||
               settings.target);
  EXPECT_EQ(settings.imu, "imu/data") << "without the slash";
  EXPECT_EQ(settings.services + settings.commands + settings.diagnostics, "");
}

TEST(Ros2Settings, ErrorsNameTheKey) {
  EXPECT_NE(error_of({"imu=imu data"}).find("imu"), std::string::npos);
  EXPECT_NE(error_of({"robot.commands=2nd/commands"}).find("commands"), std::string::npos);
  EXPECT_NE(error_of({"robot.commands=''"}).find("commands"), std::string::npos);
  EXPECT_NE(error_of({"wrench.polarity=0"}).find("polarity"), std::string::npos);
  EXPECT_NE(error_of({"robot.joints=[a, b]"}).find("joints"), std::string::npos);
  EXPECT_NE(error_of({"ros.domain=233"}).find("domain"), std::string::npos);
  EXPECT_NE(error_of({"cloud.channel=cloud"}).find("channel"), std::string::npos);
  EXPECT_NE(error_of({"ros.clocks=sender"}).find("clocks"), std::string::npos);
}

/// Every key is in the page.
TEST(Ros2Settings, AreDocumented) {
  std::ifstream file(std::string(PALPATE_SOURCE_DIR) + "/docs/robots/ros2.md");
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  const config::DeclarationList list;
  settings_with(
      {"ros.peers=[a]", "robot.joints=[a, b, c, d, e, f, g]", "requests.rest_points=[[0, 0, 0]]"});
  EXPECT_GT(list.all().size(), 40u);
  for (const config::Declaration& key : list.all())
    EXPECT_NE(page.find("`" + key.name + "`"), std::string::npos) << key.path << key.name;
}

}  // namespace
}  // namespace palpate::ros2_bridge
