#include "tools/view/obstacles.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "rt/bus/text.hpp"
#include "tests/unit/tools/view/shapes.hpp"
#include "tools/view/viewer.hpp"

namespace palpate::view {
namespace {

using nlohmann::json;

math::Pose pose_of_object() {
  return math::make_pose(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ()).toRotationMatrix(),
                         {1, 0, 0.3});
}

std::vector<drawing::ObstacleDrawing> read(const std::string& list) {
  return drawing::read_obstacle_drawings(
      config::Node::from_text("robot: {urdf: " + std::string(PALPATE_SOURCE_DIR) +
                              "/sim/robot/lwr_hand.urdf}\nobstacles:\n" + list));
}

template <class Message>
void give_obstacles(Scene& scene, const char* channel, const Message& message,
                    std::int64_t time_us) {
  const auto data = encoded(message);
  scene.accept(channel, data.data(), static_cast<int>(data.size()), time_us);
  scene.refresh();
}

json head_of(const std::string& parcel) {
  std::uint32_t length = 0;
  std::memcpy(&length, parcel.data(), 4);
  return json::parse(parcel.substr(4, length));
}

TEST(Obstacles, AreDescribedToThePage) {
  const auto obstacles = read(
      "  - {name: table, shape: half_space}\n"
      "  - {name: post, shape: capsule, radius: 0.03, length: 0.12, moved: true, timeout_ms: 250}\n"
      "  - {name: palm, shape: sphere, radius: 0.05, link: hand}\n");
  json head = head_of(encode_obstacle(1, obstacles[1]));
  EXPECT_EQ(head, json::parse(R"({"type": "obstacle", "index": 1, "name": "post",
      "kind": "capsule", "size": [0.03, 0.12, 0], "carrier": "messages", "timeout_ms": 250,
      "arrays": []})"));
  EXPECT_EQ(head_of(encode_obstacle(0, obstacles[0]))["carrier"], "fixed");
  EXPECT_EQ(head_of(encode_obstacle(2, obstacles[2]))["carrier"], "link");
  drawing::ObstacleDrawing wedge = obstacles[0];
  wedge.surface.points = Eigen::Matrix3Xd::Identity(3, 3);
  wedge.surface.triangles = Eigen::Vector3i(0, 1, 2);
  const std::string parcel = encode_obstacle(3, wedge);
  std::array<float, 9> points{};
  std::array<std::int32_t, 3> triangle{};
  std::memcpy(points.data(), parcel.data() + parcel.size() - 48, 36);
  std::memcpy(triangle.data(), parcel.data() + parcel.size() - 12, 12);
  EXPECT_EQ(points, (std::array<float, 9>{1, 0, 0, 0, 1, 0, 0, 0, 1}));
  EXPECT_EQ(triangle, (std::array<std::int32_t, 3>{0, 1, 2}));
}

TEST(Obstacles, AreWhereTheLastMessageOfEachPutsThem) {
  const auto obstacles = read(
      "  - {name: table, shape: half_space, pose: {position: [0.1, 0.2, 0.3]}}\n"
      "  - {name: plate, shape: half_space, moved: true, pose: {position: [0.4, 0.5, 0.6]}}\n"
      "  - {name: lid, shape: half_space, moved: true}\n"
      "  - {name: palm, shape: sphere, radius: 0.05, link: hand}\n");
  Scene scene;
  for (const std::size_t i : {0U, 1U}) EXPECT_TRUE(place_of(obstacles[i], scene).X_WB);
  for (const std::size_t i : {2U, 3U}) EXPECT_FALSE(place_of(obstacles[i], scene).X_WB);
  for (const auto& obstacle : obstacles) EXPECT_FALSE(place_of(obstacle, scene).time_us);
  world_state_t message{};
  message.position[0] = 2;
  message.quaternion[0] = message.quaternion[3] = std::sqrt(0.5);  // a quarter turn about z
  message.twist[0] = 9;
  for (const char* name : {"table", "plate", "lid", "palm"}) {
    bus::put_text(message.name, name);
    give_obstacles(scene, "WORLD_STATE", message, 5'000'000);
  }
  robot_state_t robot{};
  robot.joint_count = 7;
  robot.quaternion[0] = 1;
  give_obstacles(scene, "ROBOT_STATE", robot, 6'000'000);
  const ObstaclePlace table = place_of(obstacles[0], scene), palm = place_of(obstacles[3], scene);
  EXPECT_TRUE(table.X_WB->translation().isApprox(Eigen::Vector3d(0.1, 0.2, 0.3)));
  EXPECT_FALSE(table.time_us) << "is fixed";
  EXPECT_GT(palm.X_WB->translation().z(), 1) << "upright at joint angles of zero";
  EXPECT_EQ(palm.time_us, 6'000'000);
  for (const std::size_t i : {1U, 2U}) {
    const ObstaclePlace place = place_of(obstacles[i], scene);
    EXPECT_TRUE(place.X_WB->translation().isApprox(Eigen::Vector3d(2, 0, 0)));
    EXPECT_EQ(place.time_us, 5'000'000);
    EXPECT_TRUE((place.X_WB->linear() * Eigen::Vector3d::UnitX())
                    .isApprox(Eigen::Vector3d::UnitY(), 1e-12));
  }
}

TEST(Obstacles, AreWhereTheDaemonHasThemWhileItPublishes) {
  const auto obstacles = read(
      "  - {name: table, shape: half_space}\n"
      "  - {name: plate, shape: half_space, moved: true}\n");
  Scene scene;
  obstacles_t published{};
  published.count = 2;
  for (int i = 0; i < 2; ++i) {
    bus::put_text(published.name[i], obstacles[static_cast<std::size_t>(i)].name);
    published.is_placed[i] = 1;
    published.position[i][2] = 0.01;
    published.quaternion[i][0] = 1;
  }
  give_obstacles(scene, "OBSTACLES", published, 1'000'000);
  world_state_t message{};
  message.quaternion[0] = 1;
  bus::put_text(message.name, "plate");
  const auto height = [&](std::size_t which) {
    return place_of(obstacles[which], scene).X_WB->translation().z();
  };
  give_obstacles(scene, "WORLD_STATE", message, 1'100'000);
  EXPECT_EQ(height(0), 0.01);
  EXPECT_EQ(height(1), 0.01);
  EXPECT_EQ(place_of(obstacles[1], scene).time_us, 1'100'000);
  give_obstacles(scene, "WORLD_STATE", message, 2'000'000);
  EXPECT_EQ(height(1), 0) << "a daemon that has ended moves it no more";
  EXPECT_EQ(height(0), 0.01);
  published.count = 9;
  give_obstacles(scene, "OBSTACLES", published, 2'000'000);
  EXPECT_EQ(scene.rejected(), 1);
}

TEST(Obstacles, AreDescribedWithTheirEstimatedDisplacement) {
  const auto obstacles = read("  - {name: table, shape: half_space}\n");
  Scene scene;
  obstacles_t published{};
  published.count = 1;
  bus::put_text(published.name[0], "table");
  published.is_placed[0] = 1;
  published.quaternion[0][0] = 1;
  published.displacement[0][2] = -0.004;
  published.deviation[0][2] = 0.0005;
  published.displacement[0][3] = 0.01;
  published.deviation[0][3] = 0.002;
  give_obstacles(scene, "OBSTACLES", published, 1'000'000);
  std::vector<float> poses;
  const json corrections =
      describe_places(obstacles, math::Pose::Identity(), scene, 1'000'000, poses)[0]["corrections"];
  ASSERT_EQ(corrections.size(), 2U) << "directions that are not free are left out";
  EXPECT_EQ(corrections[0]["axis"], "along z");
  EXPECT_NEAR(corrections[0]["displacement"], -4, 1e-9);
  EXPECT_NEAR(corrections[0]["deviation"], 0.5, 1e-9);
  EXPECT_EQ(corrections[1]["axis"], "about x");
  EXPECT_NEAR(corrections[1]["displacement"], 0.573, 1e-3);
  EXPECT_EQ(corrections[1]["unit"], "°");
}

TEST(Obstacles, AreSentToAPageOnceAndTheirPlacesInEachFrame) {
  Viewer::Options options;
  options.cell.X_WO = pose_of_object();
  options.cell.obstacles = read(
      "  - {name: table, shape: half_space, pose: {position: [1, 0, 0.3]}}\n"
      "  - {name: lid, shape: half_space, moved: true}\n");
  Viewer viewer(options, serve::Token());
  ViewerClient client;
  viewer.prepare(1);
  const serve::Delivery first = viewer.deliver(client, 1);
  ASSERT_EQ(first.parcels.size(), 3U);
  EXPECT_EQ(head_of(*first.parcels[0])["name"], "table");
  EXPECT_EQ(head_of(*first.parcels[1])["name"], "lid");
  viewer.prepare(2);
  const serve::Delivery second = viewer.deliver(client, 2);
  ASSERT_EQ(second.parcels.size(), 1U);
  const std::string& frame = *second.parcels[0];
  const json head = head_of(frame);
  EXPECT_EQ(head["obstacles"],
            json::parse("[{\"placed\": true, \"age_ms\": null, \"corrections\": []}, "
                        "{\"placed\": false, \"age_ms\": null, \"corrections\": []}]"));
  ASSERT_EQ(head["arrays"].size(), 1U);
  EXPECT_EQ(head["arrays"][0]["name"], "obstacle_poses");
  std::array<float, 14> poses{};
  std::memcpy(poses.data(), frame.data() + frame.size() - 56, 56);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(poses[i], 0, 1e-6) << "the object's origin";
  EXPECT_NEAR(std::fabs(poses[5]), 1, 1e-6) << "half a turn about z";
  for (int i = 7; i < 14; ++i) EXPECT_EQ(poses[i], 0);
}

}  // namespace
}  // namespace palpate::view
