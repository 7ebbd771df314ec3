#include "sim/scenes/obstacles.hpp"

#include <gtest/gtest.h>

#include "tests/unit/sim/scenes/stage.hpp"

namespace palpate::scenes {
namespace {

using Eigen::Vector3d;

Scene read_scene_with(const std::vector<std::string>& overrides) {
  return read_scene(config::Node::load_file(kControl, overrides));
}

/// Whether the refusal names all of `words`.
void expect_refusal(const std::vector<std::string>& overrides,
                    const std::vector<std::string>& words) {
  try {
    read_scene_with(overrides);
    FAIL() << overrides.back();
  } catch (const config::Error& error) {
    for (const std::string& word : words)
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos)
          << error.what() << " does not name " << word;
  }
}

TEST(Obstacles, AreReadWithTheirDefaults) {
  const Scene s = read_scene_with(
      {"obstacles=[{plane: {point: [0, 0, -0.1], normal: [0, 0, 2]}}, {cylinder: {point: [0.2, 0, "
       "-0.1], axis: [0, 1, 0], radius: 0.02, length: 0.3}, friction: 0.2, stiffness: 2e7, "
       "damping: "
       "3}, {cylinder: {point: [0.2, 0, 0.2], axis: [0, 1, 0], radius: 0.02}}]"});
  ASSERT_EQ(s.plant.obstacles.size(), 3u);
  const object::ObstacleOptions& table = s.plant.obstacles[0];
  EXPECT_EQ(std::get<object::HalfSpace>(table.shape).point, Vector3d(0, 0, -0.1));
  EXPECT_EQ(table.friction, 0.5);
  EXPECT_EQ(table.stiffness, 0);
  EXPECT_EQ(table.damping, 0);
  const object::ObstacleOptions& rod = s.plant.obstacles[1];
  EXPECT_EQ(std::get<object::Cylinder>(rod.shape).radius, 0.02);
  EXPECT_EQ(std::get<object::Cylinder>(rod.shape).length, 0.3);
  EXPECT_EQ(rod.friction, 0.2);
  EXPECT_EQ(rod.stiffness, 2e7);
  EXPECT_EQ(rod.damping, 3);
  EXPECT_TRUE(std::isinf(std::get<object::Cylinder>(s.plant.obstacles[2].shape).length));
  EXPECT_TRUE(read_scene_with({}).plant.obstacles.empty());
}

TEST(Obstacles, WrongOnesAreRefusedWithKeyValueAndRange) {
  const std::string plane = "obstacles=[{plane: {point: [0, 0, -0.1], normal: [0, 0, 1]}}]";
  const std::string rod =
      "obstacles=[{cylinder: {point: [0, 0, -0.1], axis: [0, 1, 0], radius: 0.02}}]";
  expect_refusal({plane, "obstacles.0.friction=-1"}, {"obstacles.0.friction", "-1", "0 to 10"});
  expect_refusal({plane, "obstacles.0.stiffness=0"}, {"obstacles.0.stiffness", "1000"});
  expect_refusal({plane, "obstacles.0.damping=1e3"}, {"obstacles.0.damping", "100"});
  expect_refusal({plane, "obstacles.0.plane.normal=[0, 0, 0]"}, {"obstacles.0.plane.normal"});
  expect_refusal({plane, "obstacles.0.plane.size=1"}, {"obstacles.0.plane.size"});
  expect_refusal({rod, "obstacles.0.cylinder.radius=0"}, {"obstacles.0.cylinder.radius"});
  expect_refusal({rod, "obstacles.0.cylinder.length=0"}, {"obstacles.0.cylinder.length"});
  expect_refusal({rod, "obstacles.0.plane={point: [0, 0, 0], normal: [0, 0, 1]}"},
                 {"obstacles.0", "plane or cylinder"});
  expect_refusal({"obstacles=[{friction: 0.1}]"}, {"obstacles.0", "plane or cylinder"});
  EXPECT_THROW(Stage(kControl, coarse({plane, "obstacles.0.stiffness=1e12"})), config::Error);
}

// Everything at once that the daemon's model does not know: what holds, carries and loads the
// object is in equilibrium all the same.
TEST(Obstacles, WorldWithEverythingIsInEquilibrium) {
  Stage stage(
      kControl,
      coarse({"object.damping=30", "object.clamp_box.upper=[0.02, 0.06, 0.06]",
              "object.clamp_pads={stiffness: 2e3, damping: 5}",
              "object.stiffness_field={deviation: 0.3, length: 0.1, seed: 4}",
              "object.material.regions=[{box: {lower: [0, 0, 0], upper: [0.25, 1, 1]}, factor: 3}]",
              "obstacles=[{plane: {point: [0, 0, -0.02], normal: [0, 0.1, 1]}, damping: 5}, "
              "{cylinder: {point: [0.2, 0.083, 0], axis: [0, 0, 1], radius: 0.02}}]",
              "pokes=[{at: 0.2, duration: 1e5, point: [0.3, 0.03, 0.06], mass: 0.02}]",
              "slips=[{at: 1, duration: 0.5, translation: [0.006, 0, 0]}]",
              "motion={poses: [{move: 1.5, hold: 10, translation: [-0.01, 0.02, -0.03], "
              "rotation_deg: [0, -15, 0]}]}"}));
  stage.run(4);
  const object::HyperelasticPlant& plant = stage.simulation.plant();
  ASSERT_EQ(plant.obstacle_count(), 2);
  math::Vector6d sum = plant.clamp_wrench().vector();
  double scale = sum.head<3>().norm();
  for (int i = 0; i < 2; ++i) {
    const math::Vector6d contact = plant.obstacle(i).mean_wrench().vector();
    EXPECT_GT(contact.head<3>().norm(), 0.02) << i;
    EXPECT_LT(plant.obstacle(i).touch().depth, 5e-4) << i;  // on an edge of the bar
    sum += contact;
    scale += contact.head<3>().norm();
  }
  const auto add = [&sum](const Vector3d& point, const Vector3d& force) {
    sum.head<3>() += force;
    sum.tail<3>() += point.cross(force);
  };
  const math::Wrench hand = plant.hand_wrench();
  sum.tail<3>() += hand.torque;
  add(stage.simulation.grasp_in_object().translation(), hand.force);
  const Vector3d gravity(0, 0, -9.81);
  for (int n = 0; n < plant.nodal_masses().size(); ++n)
    add(plant.positions().col(n), plant.nodal_masses()[n] * gravity);
  add(plant.position_at({0.3, 0.03, 0.06}), 0.02 * gravity);
  scale += hand.force.norm();
  EXPECT_LT(sum.head<3>().norm(), 3e-3 * scale);
  EXPECT_LT(sum.tail<3>().norm(), 3e-3 * scale * 0.5);
  EXPECT_NEAR(plant.grasp().slip().distance, 0.006, 1e-9);
  EXPECT_TRUE(stage.simulation.object().remarks().empty());
}

TEST(Obstacles, TableAndRodOfTheScenesAreTouchedAndLeft) {
  for (const char* name : {"bar_long_soft_table", "bar_long_soft_cylinder"}) {
    Stage stage(PALPATE_SOURCE_DIR "/sim/scenes/" + std::string(name) + ".yaml");
    const Simulation& s = stage.simulation;
    const object::ObstacleContact& contact = s.plant().obstacle(0);
    double begin = 0, end = 0, most = 0, deepest = 0;
    while (s.time() < s.scene().motion->duration()) {
      stage.simulation.step();
      const object::ObstacleTouch& touch = contact.touch();
      if (touch.touching && begin == 0) begin = s.time();
      if (touch.touching) end = s.time();
      most = std::max(most, contact.mean_wrench().force.norm());
      deepest = std::max(deepest, touch.depth);
    }
    std::printf("%s: contact from %.2f to %.2f s, at most %.2f N and %.3f mm deep\n", name, begin,
                end, most, 1e3 * deepest);
    EXPECT_GT(begin, 4);
    EXPECT_LT(begin, 6);
    EXPECT_GT(end, 12);
    EXPECT_LT(end, 16.5);
    EXPECT_GT(most, 0.2);
    EXPECT_LT(deepest, 1e-4);
  }
}

}  // namespace
}  // namespace palpate::scenes
