#include "tools/drawing/obstacle_drawing.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "core/kinematics/serial_chain.hpp"
#include "rt/bus/text.hpp"
#include "rt/registry/arm_model.hpp"
#include "tests/support/scratch_folder.hpp"

namespace palpate::drawing {
namespace {

const std::string kCarrier = std::string(PALPATE_SOURCE_DIR) + "/sim/robot/lwr_hand.urdf";

std::vector<ObstacleDrawing> read(const std::string& list) {
  return read_obstacle_drawings(
      config::Node::from_text("robot: {urdf: " + kCarrier + "}\nobstacles:\n" + list));
}

TEST(ObstacleDrawing, HasTheShapeOfTheConfiguration) {
  const support::ScratchFolder folder;
  const std::string file = (folder.path() / "wedge.obj").string();
  std::ofstream(file) << "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\n"
                         "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  const auto obstacles = read(
      "  - {name: table, shape: half_space}\n"
      "  - {name: crate, shape: box, size: [0.1, 0.2, 0.3]}\n"
      "  - {name: ball, shape: sphere, radius: 0.04}\n"
      "  - {name: rod, shape: cylinder, radius: 0.02}\n"
      "  - {name: peg, shape: cylinder, radius: 0.02, length: 0.2}\n"
      "  - {name: post, shape: capsule, radius: 0.03, length: 0.12}\n"
      "  - {name: wedge, shape: mesh, cell: 0.01, file: " +
      file + "}\n");
  struct Expected {
    const char *name, *kind;
    Eigen::Vector3d size;
  };
  const Expected expected[] = {
      {"table", "half_space", {0, 0, 0}},  {"crate", "box", {0.1, 0.2, 0.3}},
      {"ball", "sphere", {0.04, 0, 0}},    {"rod", "cylinder", {0.02, 0, 0}},
      {"peg", "cylinder", {0.02, 0.2, 0}}, {"post", "capsule", {0.03, 0.12, 0}},
      {"wedge", "mesh", {0, 0, 0}}};
  ASSERT_EQ(obstacles.size(), std::size(expected));
  for (std::size_t i = 0; i < obstacles.size(); ++i) {
    EXPECT_EQ(obstacles[i].name, expected[i].name);
    EXPECT_EQ(obstacles[i].kind, expected[i].kind);
    EXPECT_TRUE(obstacles[i].size.isApprox(expected[i].size, 1e-12)) << expected[i].name;
    const bool is_mesh = obstacles[i].kind == "mesh";
    EXPECT_EQ(obstacles[i].surface.triangle_count(), is_mesh ? 4 : 0);
    EXPECT_EQ(obstacles[i].surface.point_count(), is_mesh ? 4 : 0);
  }
}

world_state_t moved_to(double x) {
  world_state_t message{};
  message.position[0] = x;
  message.quaternion[0] = 1;
  return message;
}

TEST(ObstacleDrawing, IsWhereConfigurationOrMessagePutsIt) {
  const auto obstacles = read(
      "  - {name: table, shape: half_space, pose: {position: [0.1, 0.2, 0.3]}}\n"
      "  - {name: plate, shape: half_space, moved: true, pose: {position: [0.4, 0.5, 0.6]}}\n"
      "  - {name: lid, shape: half_space, moved: true}\n");
  const auto at = [&](std::size_t which, const world_state_t* message) {
    const auto X_WB = pose_in_world(obstacles[which], {nullptr, nullptr, message});
    return X_WB ? Eigen::Vector3d(X_WB->translation()) : Eigen::Vector3d(0, 0, 1e9);
  };
  const world_state_t message = moved_to(7);
  EXPECT_EQ(at(0, nullptr), Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(at(0, &message), Eigen::Vector3d(0.1, 0.2, 0.3)) << "is fixed";
  EXPECT_EQ(at(1, nullptr), Eigen::Vector3d(0.4, 0.5, 0.6));
  EXPECT_EQ(at(1, &message), Eigen::Vector3d(7, 0, 0));
  EXPECT_EQ(at(2, nullptr).z(), 1e9) << "is not there yet";
  EXPECT_EQ(at(2, &message), Eigen::Vector3d(7, 0, 0));
}

TEST(ObstacleDrawing, IsWhereTheDaemonHasIt) {
  const auto obstacles = read(
      "  - {name: table, shape: half_space}\n"
      "  - {name: lid, shape: half_space, moved: true}\n"
      "  - {name: plate, shape: half_space, moved: true, pose: {position: [0.4, 0.5, 0.6]}}\n");
  obstacles_t published{};
  published.count = 2;
  bus::put_text(published.name[0], "lid");
  bus::put_text(published.name[1], "table");
  published.is_placed[1] = 1;
  published.position[1][2] = -0.01;
  published.quaternion[1][0] = 1;
  const world_state_t message = moved_to(7);
  const PlacingMessages messages{&published, nullptr, &message};
  EXPECT_EQ(pose_in_world(obstacles[0], messages)->translation(), Eigen::Vector3d(0, 0, -0.01));
  EXPECT_FALSE(pose_in_world(obstacles[1], messages)) << "the daemon has not placed it";
  EXPECT_EQ(pose_in_world(obstacles[2], messages)->translation().x(), 7) << "is not published";
  published.quaternion[1][0] = 0.5;
  EXPECT_FALSE(pose_in_world(obstacles[0], messages)) << "no rotation";
}

TEST(ObstacleDrawing, OfALinkFollowsTheJoints) {
  const auto obstacles = read(
      "  - {name: elbow, shape: sphere, radius: 0.1, link: link_4}\n"
      "  - {name: palm, shape: sphere, radius: 0.05, link: hand, pose: {position: [0, 0, 0.1]}}\n");
  robot_state_t robot{};
  const Eigen::VectorXd q = (Eigen::VectorXd(7) << 0.4, -1.1, 0.3, 1.2, -0.2, 0.7, 0.9).finished();
  std::copy_n(q.data(), 7, robot.q);
  EXPECT_FALSE(pose_in_world(obstacles[1], {}));
  robot.joint_count = 6;
  EXPECT_FALSE(pose_in_world(obstacles[1], {nullptr, &robot, nullptr}));
  EXPECT_TRUE(pose_in_world(obstacles[0], {nullptr, &robot, nullptr})) << "needs four joints";
  robot.joint_count = 7;
  kinematics::SerialChain::State state;
  registry::read_urdf(kCarrier, "hand").evaluate(q, state);
  const auto X_WB = pose_in_world(obstacles[1], {nullptr, &robot, nullptr});
  ASSERT_TRUE(X_WB);
  EXPECT_TRUE(X_WB->translation().isApprox(state.X_WE * Eigen::Vector3d(0, 0, 0.1), 1e-12));
  EXPECT_TRUE(X_WB->linear().isApprox(state.X_WE.linear(), 1e-12));
}

}  // namespace
}  // namespace palpate::drawing
