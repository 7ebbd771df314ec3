#include "tools/lab/runs/experiments.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "core/math/rigid.hpp"
#include "rt/config/node.hpp"

namespace palpate::runs {
namespace {

const std::filesystem::path kFolder =
    std::filesystem::path(PALPATE_SOURCE_DIR) / "tools/lab/studies";

const std::filesystem::path kScene =
    std::filesystem::path(PALPATE_SOURCE_DIR) / "sim/scenes/bar_long_soft_six_poses.yaml";
const std::filesystem::path kConfiguration =
    std::filesystem::path(PALPATE_SOURCE_DIR) / "rt/config/examples/bar_long_soft.yaml";

Mismatch level(const std::string& name) {
  return read_mismatch(kFolder / "mismatch.yaml", name, kScene, kConfiguration);
}

/// The value that an override gives to a key, as palpated would read it.
config::Node settings(const std::vector<std::string>& overrides) {
  const std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) / "palpate_empty.yaml";
  std::fclose(std::fopen(file.c_str(), "w"));
  return config::Node::load_file(file, overrides);
}

TEST(Mismatch, NoneChangesNothing) {
  const Mismatch none = level("none");
  EXPECT_TRUE(none.scene.empty());
  EXPECT_TRUE(none.daemon.empty());
}

TEST(Mismatch, AllIsAsLargeAsItSays) {
  const Mismatch all = level("all");
  const config::Node scene = settings(all.scene);
  const config::Node sensors = scene.child("sensors");
  const math::Pose error = sensors.pose("kinematics_error");
  EXPECT_NEAR(error.translation().norm(), 1e-3, 1e-5);
  EXPECT_NEAR(math::log_rotation(error.linear()).norm() * 180 / M_PI, 0.5, 5e-3);
  const std::vector<double> bias = sensors.child("force_torque").numbers("bias", 6);
  EXPECT_NEAR(std::hypot(bias[0], bias[1], bias[2]), 0.05, 1e-4);
  const config::Node material = settings(all.daemon).child("object").child("material");
  const config::Node exact =
      config::Node::load_file(kConfiguration.string()).child("object").child("material");
  EXPECT_NEAR(material.number("young_modulus", {}) / exact.number("young_modulus", {}), 1.3, 1e-9);
  EXPECT_NEAR(std::abs(material.number("poisson_ratio", {}) - exact.number("poisson_ratio", {})),
              0.15, 1e-9);
}

TEST(Mismatch, AllIsEachOfTheOthers) {
  std::vector<std::string> scene, daemon;
  for (const char* part :
       {"Young's modulus", "Poisson's ratio", "mesh", "force bias", "hand pose", "pads"}) {
    const Mismatch one = level(part);
    EXPECT_EQ(one.scene.size() + one.daemon.size(), 1u) << part;
    scene.insert(scene.end(), one.scene.begin(), one.scene.end());
    daemon.insert(daemon.end(), one.daemon.begin(), one.daemon.end());
  }
  EXPECT_EQ(level("all").scene, scene);
  EXPECT_EQ(level("all").daemon, daemon);
}

TEST(Mismatch, UnknownLevelNamesTheKnownOnes) {
  try {
    level("some");
    FAIL();
  } catch (const config::Error& error) {
    EXPECT_NE(std::string(error.what()).find("none, all"), std::string::npos) << error.what();
  }
}

TEST(Methods, TheFirstIsTheFilterAndNoTwoAreAlike) {
  const std::vector<Method> methods = read_methods(kFolder / "methods.yaml");
  ASSERT_GE(methods.size(), 2u);
  EXPECT_EQ(methods[0].overrides,
            std::vector<std::string>{"estimation.component=pose_wrench_filter"});
  std::set<std::vector<std::string>> different;
  for (const Method& method : methods)
    EXPECT_TRUE(different.insert(method.overrides).second) << method.name;
}

TEST(Targets, AreTheRestFeatureDisplaced) {
  const std::vector<ControlTarget> targets = read_targets(kFolder / "targets.yaml");
  ASSERT_FALSE(targets.empty());
  for (const ControlTarget& target : targets) {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& point : target.rest_points)
      centre += point / static_cast<double>(target.rest_points.size());
    EXPECT_LT((target.values.head<3>() - centre - target.displacement).norm(), 1e-12)
        << target.name;
    ASSERT_EQ(target.values.size(), target.kind == "pose" ? 7 : 3);
    if (target.kind != "pose") continue;
    EXPECT_TRUE(math::is_unit_quaternion(target.values.data() + 3));
  }
}

TEST(Targets, OfASetOfPointsEveryOneIsDisplaced) {
  ControlTarget target;
  target.kind = "points";
  target.rest_points = {{0.25, 0.03, 0.06}, {0.3, 0.03, 0.06}};
  target.displacement = {0.01, 0, -0.02};
  target.displace();
  ASSERT_EQ(target.values.size(), 6);
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector3d moved = target.values.segment<3>(3 * i) - target.rest_points[i];
    EXPECT_LT((moved - target.displacement).norm(), 1e-12);
  }
}

TEST(Targets, OverridesPutTheFeatureIntoItsSlot) {
  ControlTarget target;
  target.kind = "point";
  target.rest_points = {{0.25, 0.03, 0.06}};
  const config::Node feature = settings(target.daemon_overrides()).child("feature");
  EXPECT_EQ(feature.text("component"), "point");
  EXPECT_EQ(feature.points("rest_points").at(0), target.rest_points[0]);
}

TEST(Targets, OverridesContainAllThatDefinesTheFeature) {
  ControlTarget target;
  target.kind = "fourier_contour";
  target.rest_points = {{0, 0, 0}, {0.1, 0, 0}, {0.1, 0.1, 0}};
  target.harmonics = 1;
  target.closed = false;
  target.components = {0, 1};
  target.axis = Eigen::Vector3d(0, -1, 0);
  const config::Node feature = settings(target.daemon_overrides()).child("feature");
  EXPECT_EQ(feature.integer({"harmonics", "", ""}, {1, 31}, 3), 1);
  EXPECT_FALSE(feature.flag({"closed", "", ""}, true));
  EXPECT_EQ(feature.numbers({"components", "", ""}, 2, {0, 2}), (std::vector<double>{0, 1}));
  EXPECT_EQ(feature.vector3({"axis", "", ""}), Eigen::Vector3d(0, -1, 0));
  target.displace();
  EXPECT_EQ(target.values.size(), 4);
}

}  // namespace
}  // namespace palpate::runs
