// Obstacles of the configuration, and what is said of faults in them.

#include "rt/registry/obstacles.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "core/elasticity/corotational_model.hpp"
#include "rt/registry/registry.hpp"

namespace palpate::registry {
namespace {

std::vector<ConfiguredObstacle> read_all(const std::string& text,
                                         const math::Pose& X_WO = math::Pose::Identity()) {
  const config::Node root = config::Node::from_text(text, "cell.yaml");
  std::vector<ConfiguredObstacle> obstacles = read_obstacles(root, X_WO);
  if (root.has("robot")) read_arm_model(root);
  root.check_all_used();
  return obstacles;
}

std::vector<collision::Obstacle> read_obstacles_of(
    const std::string& list, const math::Pose& X_WO = math::Pose::Identity()) {
  std::vector<collision::Obstacle> bodies;
  for (const ConfiguredObstacle& obstacle : read_all("obstacles:\n" + list, X_WO))
    bodies.push_back(obstacle.limited.body);
  return bodies;
}

const char* const kArm = "robot: {urdf: " PALPATE_SOURCE_DIR "/sim/robot/lwr_hand.urdf}\n";

TEST(Obstacles, EachShapeIsReadAndPlacedInO) {
  const math::Pose X_WO = math::make_pose(math::exp_rotation({0, 0, M_PI}), {1.36, 0.03, 0.28});
  const auto obstacles = read_obstacles_of(
      "  - {name: table, shape: half_space, pose: {position: [0, 0, 0.255]}, friction: 0.7}\n"
      "  - {name: rod, shape: cylinder, radius: 0.03, length: 0.2,\n"
      "     pose: {position: [1.12, 0, 0.235], rpy_deg: [90, 0, 0]}}\n"
      "  - {name: crate, shape: box, size: [0.2, 0.1, 0.04]}\n"
      "  - {name: ball, shape: sphere, radius: 0.02}\n"
      "  - {name: finger, shape: capsule, radius: 0.01, length: 0.05}\n",
      X_WO);
  ASSERT_EQ(obstacles.size(), 5u);
  EXPECT_EQ(obstacles[0].name, "table");
  EXPECT_EQ(obstacles[0].friction, 0.7);
  EXPECT_NEAR(collision::distance(obstacles[0], {0.3, 0.1, -0.02}), 0.005, 1e-12);
  // below the middle of a bar along x of O
  EXPECT_NEAR(collision::distance(obstacles[1], {0.24, 0.03, -0.01}), 0.005, 1e-12);
  EXPECT_NEAR(collision::distance(obstacles[1], {0.24, 0.14, -0.045}), 0.01, 1e-12);
  EXPECT_NEAR(collision::distance(obstacles[2], X_WO.inverse() * Eigen::Vector3d(0.11, 0, 0)), 0.01,
              1e-12);
  EXPECT_NEAR(collision::distance(obstacles[3], X_WO.inverse() * Eigen::Vector3d(0.05, 0, 0)), 0.03,
              1e-12);
  EXPECT_NEAR(collision::distance(obstacles[4], X_WO.inverse() * Eigen::Vector3d(0, 0, 0.04)),
              0.005, 1e-12);
}

TEST(Obstacles, ASurfaceFileBecomesAGridOfDistances) {
  const std::string file = ::testing::TempDir() + "obstacle.obj";
  std::ofstream(file) << "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\n"
                         "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  const auto obstacles =
      read_obstacles_of("  - {name: wedge, shape: mesh, cell: 0.004, file: " + file + "}\n");
  EXPECT_NEAR(collision::distance(obstacles[0], {0.03, 0.03, -0.005}), 0.005, 1e-6);
  EXPECT_LT(collision::distance(obstacles[0], {0.02, 0.02, 0.02}), 0);
}

void expect_error(const std::string& list, const std::string& part) {
  try {
    read_obstacles_of(list);
    ADD_FAILURE() << "accepted: " << list;
  } catch (const config::Error& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

TEST(Obstacles, FaultsAreNamed) {
  expect_error("  - {shape: half_space}\n", "name");
  expect_error("  - {name: a, shape: plane}\n", "half_space");
  expect_error("  - {name: a, shape: sphere}\n", "radius");
  expect_error("  - {name: a, shape: sphere, radius: -1}\n", "radius");
  expect_error("  - {name: a, shape: capsule, radius: 0.1}\n", "length");
  expect_error("  - {name: a, shape: half_space, radius: 0.1}\n", "radius");
  expect_error("  - {name: a, shape: half_space, friction: -0.1}\n", "friction");
  expect_error("  - {name: a, shape: half_space}\n  - {name: a, shape: half_space}\n",
               "another obstacle");
  expect_error("  - {name: a, shape: mesh, file: missing.stl}\n", "missing.stl");
  expect_error("  - {name: a_name_of_24_characters_, shape: half_space}\n", "23 characters");
  std::string nine;
  for (const char letter : std::string("abcdefghi"))
    nine += std::string("  - {name: ") + letter + ", shape: half_space}\n";
  expect_error(nine, "at most 8");
}

TEST(Obstacles, HaveLimitsOfTheirOwn) {
  const auto obstacles = read_all(
      "obstacles:\n"
      "  - {name: default, shape: half_space}\n"
      "  - {name: near, shape: half_space, clearance: 0.001}\n"
      "  - {name: table, shape: half_space, allowed: contact, force: 3}\n");
  EXPECT_FALSE(obstacles[0].limited.may_touch);
  EXPECT_EQ(obstacles[0].limited.clearance, 0.005);
  EXPECT_TRUE(std::isinf(obstacles[0].limited.force));
  EXPECT_EQ(obstacles[1].limited.clearance, 0.001);
  EXPECT_TRUE(obstacles[2].limited.may_touch);
  EXPECT_EQ(obstacles[2].limited.force, 3);
  expect_error("  - {name: a, shape: half_space, allowed: contact, clearance: 0.1}\n",
               "where contact is allowed");
  expect_error("  - {name: a, shape: half_space, allowed: some}\n", "contact");
  expect_error("  - {name: a, shape: half_space, force: 0}\n", "force");
}

TEST(Obstacles, SayHowFarTheirPoseMayBeOff) {
  const auto obstacles = read_all(
      "obstacles:\n"
      "  - {name: floor, shape: half_space}\n"
      "  - {name: table, shape: half_space, pose_deviation: {position: [0, 0, 0.01], rotation_deg: "
      "[1, 0, 0]}}\n");
  EXPECT_TRUE(obstacles[0].limited.body.pose_deviation.isZero(0));
  const auto directions = free_directions(obstacles);
  ASSERT_EQ(directions.size(), 2u);
  EXPECT_EQ(directions[0].obstacle, 1);
  EXPECT_EQ(directions[0].axis, 2);
  EXPECT_EQ(directions[0].deviation, 0.01);
  EXPECT_EQ(directions[1].axis, 3);
  EXPECT_NEAR(directions[1].deviation, M_PI / 180, 1e-15);
  expect_error("  - {name: a, shape: half_space, pose_deviation: {position: [0, 0, -1]}}\n",
               "position");
  expect_error("  - {name: a, shape: half_space, pose_deviation: {heading: 1}}\n", "heading");
  const std::string free =
      "pose_deviation: {position: [1e-3, 1e-3, 1e-3], rotation_deg: [1, 1, 1]}";
  expect_error("  - {name: a, shape: half_space, " + free + "}\n  - {name: b, shape: half_space, " +
                   free + "}\n",
               "at most 6");
}

TEST(Obstacles, AreCarriedByLinksOrMovedByMessages) {
  const auto obstacles =
      read_all(kArm + std::string("obstacles:\n"
                                  "  - {name: elbow, shape: sphere, radius: 0.1, link: link_4}\n"
                                  "  - {name: palm, shape: sphere, radius: 0.05, link: hand,\n"
                                  "     pose: {position: [0, 0, 0.1]}}\n"
                                  "  - {name: lid, shape: sphere, radius: 0.1, moved: true}\n"
                                  "  - {name: tray, shape: sphere, radius: 0.1, moved: true,\n"
                                  "     timeout_ms: 250, pose: {position: [0, 0, 1]}}\n"));
  using Kind = ObstacleCarrier::Kind;
  EXPECT_EQ(obstacles[0].carrier.kind, Kind::kLink);
  EXPECT_EQ(obstacles[0].carrier.link->joint_count(), 4);
  EXPECT_EQ(obstacles[0].limited.body.hand, -1);
  EXPECT_FALSE(obstacles[0].limited.body.is_known);
  EXPECT_EQ(obstacles[1].carrier.link->joint_count(), 7);
  EXPECT_EQ(obstacles[1].carrier.X_AB.translation().z(), 0.1);
  EXPECT_EQ(obstacles[1].limited.body.hand, 0) << "beyond the flange";
  EXPECT_EQ(obstacles[2].carrier.kind, Kind::kMessages);
  EXPECT_EQ(obstacles[2].carrier.timeout, 0.1);
  EXPECT_FALSE(obstacles[2].limited.body.is_known);
  EXPECT_EQ(obstacles[3].carrier.timeout, 0.25);
  EXPECT_TRUE(obstacles[3].limited.body.is_known);
  EXPECT_EQ(obstacles[3].limited.body.X_OB.translation().z(), 1);
}

TEST(Obstacles, FaultsOfTheirCarriersAreNamed) {
  const auto error = [](const std::string& arm, const std::string& keys) -> std::string {
    try {
      read_all(arm + "obstacles:\n  - {name: a, shape: half_space, " + keys + "}\n");
    } catch (const config::Error& fault) {
      return fault.what();
    }
    return "";
  };
  EXPECT_THAT(error("", "link: hand"), testing::HasSubstr("section robot"));
  EXPECT_THAT(error(kArm, "link: nowhere"), testing::HasSubstr("nowhere"));
  EXPECT_THAT(error(kArm, "link: ff_tip"), testing::HasSubstr("joint ff_j4"));
  EXPECT_THAT(error(kArm, "link: hand, moved: true"), testing::HasSubstr("not both"));
  EXPECT_THAT(error("", "timeout_ms: 10"), testing::HasSubstr("timeout_ms"));
  EXPECT_THAT(error("", "moved: true, timeout_ms: 0"), testing::HasSubstr("timeout_ms"));
}

/// Model of the example with a table, with another component.
std::unique_ptr<elasticity::DeformationModel> model_on_a_table(const std::string& component) {
  const config::Node root = config::Node::load_file(
      std::string(PALPATE_SOURCE_DIR) + "/rt/config/examples/bar_long_soft_table.yaml",
      {"deformation={component: " + component + "}"});
  Context context;
  context.frames = read_frames(root);
  const Object object = read_object(root, context.frames);
  context.object = &object;
  return make_deformation_model(root.child("deformation"), context);
}

TEST(Obstacles, ReachTheModelThatKnowsContact) {
  for (const char* component : {"corotational_quasistatic", "corotational_dynamic"}) {
    const auto model = model_on_a_table(component);
    auto& corotational = dynamic_cast<elasticity::CorotationalModel&>(*model);
    corotational.prepare();
    math::Pose hand = model->body().grasps[0].X_OG_rest;
    for (int i = 0; i < 100; ++i) {
      hand.translation().z() -= 2.4e-4;
      hand.linear() = math::exp_rotation({0, -2e-3 * i, 0});
      corotational.hold(0, hand);
      corotational.step(1e-3);
      if (elasticity::Refactorisation* job = corotational.wanted_refactorisation()) {
        job->run();
        corotational.install(*job);
      }
    }
    double force = 0;
    for (const elasticity::SurfaceContact& contact : corotational.contacts()) {
      force += contact.force.z();
      EXPECT_GT(contact.position.z(), -0.0252) << component;
    }
    EXPECT_GT(force, 1e-3) << component;
  }
}

TEST(Obstacles, AreNotIgnoredByAModelWithoutContact) {
  for (const char* component : {"linear", "mass_spring", "shape_matching",
                                "corotational_dynamic, integrator: thesis2018"}) {
    try {
      model_on_a_table(component);
      ADD_FAILURE() << component;
    } catch (const config::Error& error) {
      EXPECT_NE(std::string(error.what()).find("obstacles"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace palpate::registry
