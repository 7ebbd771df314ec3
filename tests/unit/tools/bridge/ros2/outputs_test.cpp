#include <gtest/gtest.h>

#include <palpate/shape_mesh_t.hpp>

#include "rt/bus/stamped_publisher.hpp"
#include "rt/bus/text.hpp"
#include "tests/unit/tools/bridge/ros2/cell.hpp"
#include "tools/bridge/ros2/diagnostics.hpp"
#include "tools/bridge/ros2/shape_marker.hpp"
#include "tools/bridge/ros2/telemetry.hpp"

namespace palpate::ros2_bridge {
namespace {

TEST(Ros2Telemetry, PassesOnWrenchAndPoses) {
  const auto hub = bus::make_memory_hub();
  const auto bus = bus::make_memory_bus(hub), peer = bus::make_memory_bus(hub);
  Telemetry::Options options;
  options.wrench = "compensated";
  options.hand_pose = "hand";
  options.grasp_pose = "grasp";
  Telemetry telemetry(ours(), options, *bus);
  Reader<WrenchStamped> wrenches(theirs(), {"compensated", Quality::kStream, 4});
  Reader<PoseStamped> hands(theirs(), {"hand", Quality::kStream, 4});
  Reader<PoseStamped> grasps(theirs(), {"grasp", Quality::kStream, 4});

  bus::StampedPublisher<compensated_wrench_t> from_wrench(*peer, "WRENCH_COMPENSATED", 1);
  compensated_wrench_t wrench{};
  from_wrench.publish(wrench, 3'000'000);  // not valid
  wrench.valid = 1;
  wrench.reading_utime = 2'000'005;
  for (int i = 0; i < 6; ++i) wrench.wrench_s[i] = i;
  from_wrench.publish(wrench, 3'000'000);
  bus::StampedPublisher<robot_state_t> from_robot(*peer, "ROBOT_STATE", 1);
  robot_state_t robot{};
  robot.position[1] = 0.5;
  robot.quaternion[1] = 1;
  from_robot.publish(robot, 4'000'000);
  bus::StampedPublisher<estimate_t> from_estimate(*peer, "ESTIMATE", 1);
  estimate_t estimate{};
  estimate.grasp_count = 1;
  estimate.grasp_quaternion[0][0] = 1;
  estimate.grasp_position[0][2] = 0.25;
  from_estimate.publish(estimate, 5'000'000);
  estimate.status = estimate_t::STATUS_FAULT;
  from_estimate.publish(estimate, 6'000'000);
  telemetry.cycle();

  const WrenchStamped* const sent = wrenches.next();
  ASSERT_NE(sent, nullptr);
  EXPECT_EQ(utime_of(sent->header.stamp), 2'000'005) << "of the reading";
  EXPECT_STREQ(sent->header.frame_id, "ft_sensor");
  EXPECT_EQ(sent->wrench.torque.z, 5);
  EXPECT_EQ(wrenches.next(), nullptr);
  const PoseStamped* const hand = hands.next();
  ASSERT_NE(hand, nullptr);
  EXPECT_EQ(hand->pose.position.y, 0.5);
  EXPECT_EQ(hand->pose.orientation.x, 1);
  EXPECT_STREQ(hand->header.frame_id, "base_link");
  const PoseStamped* const grasp = grasps.next();
  ASSERT_NE(grasp, nullptr);
  EXPECT_EQ(grasp->pose.position.z, 0.25);
  EXPECT_EQ(grasp->pose.orientation.w, 1);
  EXPECT_EQ(grasps.next(), nullptr);
}

template <class Message>
void show(ShapeMarker& marker, const char* channel, const Message& message) {
  std::vector<std::uint8_t> data(message.getEncodedSize());
  message.encode(data.data(), 0, static_cast<int>(data.size()));
  marker.take(channel, data.data(), static_cast<int>(data.size()), 0);
}

TEST(ShapeMarker, HasThreePointsForEachTriangle) {
  ShapeMarker::Options options;
  options.topic = "shape";
  options.X_WO.translation() = Eigen::Vector3d(0.5, 0, 1);
  ShapeMarker marker(ours(), options);
  Reader<Marker> markers(theirs(), {"shape", Quality::kReliable, 4});
  shape_mesh_t mesh{};
  mesh.mesh_hash = 5;
  mesh.chunks = 1;
  mesh.node_count = 4;
  mesh.rest_xyz = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  mesh.element_size = 4;
  mesh.elements = {0, 1, 2, 3};
  mesh.triangles = {3, 1, 2, 0, 2, 1};
  mesh.rest_xyz_count = static_cast<int>(mesh.rest_xyz.size());
  mesh.element_index_count = static_cast<int>(mesh.elements.size());
  mesh.triangle_index_count = static_cast<int>(mesh.triangles.size());
  show(marker, "SHAPE_MESH", mesh);
  shape_t shape{};
  shape.utime = 7'000'000;
  shape.mesh_hash = 5;
  shape.chunks = 1;
  shape.node_count = 4;
  shape.xyz = mesh.rest_xyz;
  shape.xyz[11] = 1.5F;
  shape.xyz_count = static_cast<int>(shape.xyz.size());
  show(marker, "SHAPE", shape);

  const Marker* const sent = markers.next();
  ASSERT_NE(sent, nullptr);
  EXPECT_EQ(sent->type, 11);
  EXPECT_EQ(sent->pose.position.z, 1);
  EXPECT_EQ(sent->scale.x, 1);
  EXPECT_EQ(sent->lifetime.sec, 1);
  EXPECT_EQ(sent->header.stamp.sec, 7);
  ASSERT_EQ(sent->points._length, 6u);
  EXPECT_EQ(sent->points._buffer[0].z, 1.5);
  EXPECT_EQ(sent->points._buffer[1].x, 1);
  EXPECT_EQ(sent->points._buffer[4].y, 1);
}

TEST(Diagnostics, ReportHealthAbsenceAndEvents) {
  const auto hub = bus::make_memory_hub();
  const auto bus = bus::make_memory_bus(hub), peer = bus::make_memory_bus(hub);
  Diagnostics diagnostics(ours(), "diagnostics", *bus, [] {
    return std::vector<std::pair<std::string, std::string>>{{"topic", "3 accepted"}};
  });
  Reader<DiagnosticArray> arrays(theirs(), {"diagnostics", Quality::kReliable, 10});

  diagnostics.cycle(10'000'000);
  const DiagnosticArray* array = arrays.next();
  ASSERT_NE(array, nullptr);
  ASSERT_EQ(array->status._length, 2u);
  EXPECT_EQ(array->status._buffer[0].level, Diagnosis::kStale);
  ASSERT_EQ(array->status._buffer[1].values._length, 1u);
  EXPECT_STREQ(array->status._buffer[1].values._buffer[0].value, "3 accepted");

  bus::StampedPublisher<component_event_t> events(*peer, "COMPONENT_EVENT", 1);
  component_event_t event{};
  bus::put_text(event.slot, "sensing");
  bus::put_text(event.event, "refused");
  bus::put_text(event.reason, "why");
  events.publish(event, 1);
  diagnostics.cycle(10'001'000);
  array = arrays.next();
  ASSERT_NE(array, nullptr) << "events at once";
  ASSERT_EQ(array->status._length, 1u);
  EXPECT_EQ(array->status._buffer[0].level, Diagnosis::kWarning);
  EXPECT_STREQ(array->status._buffer[0].name, "palpated: sensing");
  EXPECT_STREQ(array->status._buffer[0].message, "refused: why");

  bus::StampedPublisher<health_t> healths(*peer, "HEALTH", 1);
  health_t health{};
  health.state = health_t::STATE_FAULTED;
  health.input_count = 1;
  bus::put_text(health.input_name[0], "FT_WRENCH");
  healths.publish(health, 1);
  diagnostics.cycle(11'500'000);
  array = arrays.next();
  ASSERT_NE(array, nullptr);
  EXPECT_EQ(array->status._buffer[0].level, Diagnosis::kError);
  EXPECT_STREQ(array->status._buffer[0].message, "faulted");
  ASSERT_EQ(array->status._buffer[0].values._length, 6u);
  EXPECT_STREQ(array->status._buffer[0].values._buffer[5].key, "FT_WRENCH");
}

}  // namespace
}  // namespace palpate::ros2_bridge
