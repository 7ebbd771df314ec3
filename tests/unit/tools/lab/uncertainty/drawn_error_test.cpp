#include "tools/lab/uncertainty/drawn_error.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "rt/config/node.hpp"
#include "rt/pipeline/pipeline.hpp"
#include "sim/scenes/scene.hpp"
#include "tools/common/output_files.hpp"
#include "tools/lab/uncertainty/draws_command.hpp"

namespace palpate::uncertainty {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::filesystem::path kRoot = PALPATE_SOURCE_DIR;

std::filesystem::path scene_of(const std::string& object) {
  return kRoot / "sim/scenes" / (object + "_six_poses.yaml");
}
std::filesystem::path configuration_of(const std::string& object) {
  return kRoot / "rt/config/examples" / (object + ".yaml");
}

Distributions shipped(const std::string& name) {
  return read_distributions(distributions_file(kRoot, name));
}

runs::Mismatch draw(const Distributions& distributions, int index, int count = 20,
                    const std::string& object = "bar_long_soft", std::uint64_t seed = 1) {
  return draw_mismatch(distributions, {seed, count}, index, scene_of(object),
                       configuration_of(object));
}

double value_of(const runs::Mismatch& level, const std::string& parameter) {
  const auto found =
      std::find_if(level.drawn.begin(), level.drawn.end(),
                   [&](const runs::DrawnValue& value) { return value.parameter == parameter; });
  EXPECT_NE(found, level.drawn.end()) << parameter;
  return found == level.drawn.end() ? NAN : found->value;
}

scenes::Scene scene_under(const runs::Mismatch& level, const std::string& object) {
  return scenes::read_scene(config::Node::load_file(scene_of(object).string(), level.scene));
}

class Distribution : public testing::Test {
 protected:
  std::string error_of(const std::string& text) const {
    const std::filesystem::path file = folder_.path() / "mine.yaml";
    std::ofstream(file) << text;
    try {
      read_distributions(file);
    } catch (const config::Error& error) {
      return error.what();
    }
    return "";
  }
  common::TemporaryFolder folder_{"palpate-distributions-"};
};

TEST_F(Distribution, ShippedFilesAreRead) {
  const Distributions calibrated = shipped("calibrated"), uncalibrated = shipped("uncalibrated");
  EXPECT_EQ(calibrated.name, "calibrated");
  EXPECT_EQ(calibrated.truncated_at, 2);
  EXPECT_EQ(calibrated.hand.position, 0.5e-3);
  EXPECT_EQ(calibrated.young_modulus, 0.2);
  EXPECT_EQ(calibrated.creep, 0);
  EXPECT_EQ(uncalibrated.hand.angle_deg, 1);
  EXPECT_EQ(uncalibrated.pads_factor, 5);
  EXPECT_GT(uncalibrated.creep, 0);
}

TEST_F(Distribution, ErrorsNameFileKeyValueAndRange) {
  EXPECT_EQ(error_of("hand: {position: 0.001}\n"), "");
  EXPECT_THAT(error_of("hand: {position: 0.5}\n"),
              AllOf(HasSubstr("mine.yaml:1"), HasSubstr("hand.position"), HasSubstr("0.5"),
                    HasSubstr("0.1")));
  EXPECT_THAT(error_of("hand: {position: -1e-3}\n"), HasSubstr("hand.position"));
  EXPECT_THAT(error_of("hands: {position: 0}\n"), HasSubstr("hands"));
  EXPECT_THAT(error_of("truncated_at: 5\n"), AllOf(HasSubstr("truncated_at"), HasSubstr("3")));
  EXPECT_THAT(error_of("creep: {relative_modulus: 0.1}\n"), HasSubstr("creep.relaxation_time"));
  EXPECT_THAT(error_of("creep: {relative_modulus: 0.1, relaxation_time: [9, 1]}\n"),
              HasSubstr("creep.relaxation_time"));
}

TEST(DrawnError, EveryDrawIsAcceptedForTheShippedObjects) {
  constexpr int kDraws = 3;
  for (const char* object : {"bar_long_soft", "bar_long_hard", "block_soft", "block_hard"})
    for (const char* name : {"calibrated", "uncalibrated"})
      for (int i = 1; i <= kDraws; ++i) {
        SCOPED_TRACE(std::string(object) + ", " + name + " " + std::to_string(i));
        const runs::Mismatch level = draw(shipped(name), i, kDraws, object);
        EXPECT_EQ(level.name, std::string(name) + " " + std::to_string(i));
        EXPECT_EQ(level.family, name);
        scenes::Scene scene = scene_under(level, object);
        const object::PlantOptions nominal = scene_under({}, object).plant;
        const object::HyperelasticPlant plant(scene.plant), before(nominal);
        // Clamp and hand hold what they held, in elements that need no much shorter step.
        EXPECT_EQ(plant.clamped_nodes().size(), before.clamped_nodes().size());
        EXPECT_GT(plant.critical_step(), 0.5 * before.critical_step());
        const pipeline::Pipeline daemon(
            config::Node::load_file(configuration_of(object).string(), level.daemon), 1e-3);
      }
}

TEST(DrawnError, IsTheSameForTheSameSeed) {
  const Distributions calibrated = shipped("calibrated");
  const runs::Mismatch once = draw(calibrated, 7), again = draw(calibrated, 7);
  EXPECT_EQ(once.scene, again.scene);
  EXPECT_EQ(once.daemon, again.daemon);
  EXPECT_NE(once.scene, draw(calibrated, 8).scene);
  EXPECT_NE(once.scene, draw(calibrated, 7, 20, "bar_long_soft", 2).scene);
  EXPECT_THROW(draw(calibrated, 21), std::out_of_range);
  EXPECT_THROW(draw(calibrated, 0), std::out_of_range);
}

TEST(DrawnError, ValuesHaveTheDeviationsOfTheFile) {
  constexpr int kDraws = 200;
  constexpr double kTruncated = 0.8796;  // deviation of a normal distribution truncated at two
  const Distributions calibrated = shipped("calibrated");
  double hand = 0, modulus = 0, shortest = 1, longest = 0, softest = 9, stiffest = 0;
  for (int i = 1; i <= kDraws; ++i) {
    const runs::Mismatch level = draw(calibrated, i, kDraws);
    hand += std::pow(value_of(level, "hand x"), 2) / kDraws;
    modulus += std::pow(value_of(level, "log E"), 2) / kDraws;
    shortest = std::min(shortest, value_of(level, "force-torque delay"));
    longest = std::max(longest, value_of(level, "force-torque delay"));
    softest = std::min(softest, value_of(level, "pads' stiffness factor"));
    stiffest = std::max(stiffest, value_of(level, "pads' stiffness factor"));
  }
  EXPECT_NEAR(std::sqrt(hand), 0.5e-3 * kTruncated, 0.01e-3);
  EXPECT_NEAR(std::sqrt(modulus), 0.2 * kTruncated, 0.004);
  EXPECT_GE(shortest, 0);
  EXPECT_LE(longest, 2e-3);
  EXPECT_NEAR(softest, 0.5, 0.01);
  EXPECT_NEAR(stiffest, 2, 0.02);
}

TEST(DrawnError, ReachesSceneAndDaemon) {
  const std::string object = "block_hard";
  const runs::Mismatch level = draw(shipped("uncalibrated"), 2, 20, object);
  const scenes::Scene scene = scene_under(level, object), before = scene_under({}, object);
  EXPECT_NEAR(scene.sensors.kinematics_error.translation().z(), value_of(level, "hand z"), 1e-9);
  EXPECT_NEAR(scene.sensors.force_torque.bias[4], value_of(level, "torque bias y"), 1e-9);
  EXPECT_NEAR(scene.sensors.force_torque.timing.delay - 1e-3, value_of(level, "force-torque delay"),
              1e-9);
  EXPECT_NEAR(scene.plant.grasps[0].stiffness / before.plant.grasps[0].stiffness,
              value_of(level, "pads' stiffness factor"), 1e-6);
  ASSERT_EQ(scene.plant.maxwell.size(), 1u);
  const config::Node daemon =
      config::Node::load_file(configuration_of(object).string(), level.daemon);
  const config::Node payload = daemon.list("sensing")[0].child("payload");
  EXPECT_NEAR(payload.number("mass", {}) / 4.8, 1 + value_of(level, "payload mass"), 1e-6);
  const Eigen::Vector3d gravity = daemon.child("frames").vector3("gravity_in_base");
  EXPECT_NEAR(gravity.norm(), 9.81, 1e-6);
  EXPECT_NEAR(std::acos(-gravity.z() / 9.81) * 180 / M_PI,
              std::hypot(value_of(level, "gravity about x"), value_of(level, "gravity about y")),
              1e-3);
  // The object's O is rotated by half a turn about z.
  const math::Pose X_WO = daemon.child("frames").pose("object_in_base");
  EXPECT_NEAR(X_WO.translation().y() - 0.03, -value_of(level, "clamp y"), 1e-8);
  EXPECT_NEAR(X_WO.translation().z() - 0.11, value_of(level, "clamp z"), 1e-8);
  const math::Pose X_OG = daemon.child("object").pose("grasp_at_rest");
  EXPECT_NEAR(X_OG.translation().x() - 0.37,
              value_of(level, "grasp at rest x") - value_of(level, "clamp x"), 1e-8);
}

TEST(DrawnError, FacesStayFaces) {
  for (int i = 1; i <= 10; ++i) {
    const runs::Mismatch level = draw(shipped("uncalibrated"), i, 10);
    const object::PlantOptions plant = scene_under(level, "bar_long_soft").plant;
    const Eigen::Vector3d& size = plant.size;
    EXPECT_NEAR(size.x(), 0.5 * (1 + value_of(level, "dimension x")), 1e-8);
    EXPECT_EQ(plant.clamp->upper, Eigen::Vector3d(0, size.y(), size.z()));
    EXPECT_EQ(plant.grasps[0].patch.upper, size);
    EXPECT_NEAR(plant.grasps[0].patch.lower.x(), 0.45 + value_of(level, "grasp on object"), 1e-8);
  }
}

TEST(DrawnError, PoissonsRatioStaysPossible) {
  constexpr int kDraws = 50;
  double most = 0;
  for (int i = 1; i <= kDraws; ++i) {
    const config::Node daemon =
        config::Node::load_file(configuration_of("bar_long_soft").string(),
                                draw(shipped("uncalibrated"), i, kDraws).daemon);
    const double nu = daemon.child("object").child("material").number("poisson_ratio", {});
    most = std::max(most, nu);
    EXPECT_GE(nu, 0);
    EXPECT_LE(nu, 0.48);
  }
  EXPECT_GT(most, 0.45);
}

TEST(DrawnError, PokesStayOnTheObject) {
  const std::filesystem::path scene = kRoot / "sim/scenes/bar_long_soft_pokes.yaml";
  for (int i = 1; i <= 5; ++i) {
    const runs::Mismatch level =
        draw_mismatch(shipped("uncalibrated"), {1, 5}, i, scene, configuration_of("bar_long_soft"));
    const scenes::Scene read =
        scenes::read_scene(config::Node::load_file(scene.string(), level.scene));
    EXPECT_NEAR(read.pokes[0].point.z(), read.plant.size.z(), 1e-8);
  }
}

TEST(DrawnError, WhatASetUpDoesNotHaveIsNotDrawn) {
  const auto has_camera = [](const runs::Mismatch& level) {
    return std::any_of(level.drawn.begin(), level.drawn.end(), [](const runs::DrawnValue& value) {
      return value.parameter.find("camera") == 0;
    });
  };
  const Distributions calibrated = shipped("calibrated");
  EXPECT_FALSE(has_camera(draw(calibrated, 1)));
  EXPECT_TRUE(has_camera(draw_mismatch(calibrated, {1, 1}, 1,
                                       kRoot / "sim/scenes/bar_long_soft_control_camera.yaml",
                                       configuration_of("bar_long_soft"))));
}

}  // namespace
}  // namespace palpate::uncertainty
