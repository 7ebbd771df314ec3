#include "tools/log/former_types.hpp"

#include <gtest/gtest.h>

#include <palpate/health_v1_t.hpp>
#include <palpate/imu_t.hpp>
#include <palpate/shape_mesh_v1_t.hpp>
#include <palpate/shape_v1_t.hpp>
#include <vector>

#include "tests/support/scratch_folder.hpp"
#include "tools/log/event_log.hpp"
#include "tools/log/log_reader.hpp"
#include "tools/log/plant_truth.hpp"

namespace palpate::log {
namespace {

template <class Message>
Message stamped() {
  Message message{};
  message.utime = 1234;
  message.seq = 5;
  message.session = 6;
  return message;
}

template <class Into, class Message>
bool read(const Message& message, Into& into) {
  std::vector<std::uint8_t> data(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(data.data(), 0, static_cast<int>(data.size()));
  return decode(into, data.data(), static_cast<int>(data.size()));
}

template <class Message>
void expect_stamped(const Message& message) {
  EXPECT_EQ(message.utime, 1234);
  EXPECT_EQ(message.seq, 5);
  EXPECT_EQ(message.session, 6);
}

health_v1_t former_health() {
  auto former = stamped<health_v1_t>();
  former.cycles = 7;
  former.gate_limited = 8;
  former.gate_refused = 9;
  former.commands_refused = 10;
  former.model_count = 1;
  former.model_late[0] = 11;
  former.reason[0] = 'x';
  return former;
}

shape_v1_t former_shape() {
  auto former = stamped<shape_v1_t>();
  former.mesh_hash = 77;
  former.status = shape_t::STATUS_NOT_CONVERGED;
  former.age_us = 12;
  former.node_count = 4;
  former.xyz = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  former.xyz_count = 12;
  former.deviation = {1, 2, 3, 4};
  former.deviation_count = 4;
  return former;
}

shape_mesh_v1_t former_mesh() {
  auto former = stamped<shape_mesh_v1_t>();
  former.mesh_hash = 77;
  former.element_kind = shape_mesh_t::QUADRATIC_TETRAHEDRA;
  former.chunks = 1;
  former.corner_count = 4;
  former.rest_xyz = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  former.rest_xyz_count = 12;
  former.element_size = 4;
  former.elements = {0, 1, 2, 3};
  former.element_index_count = 4;
  former.triangles = {0, 2, 1};
  former.triangle_index_count = 3;
  former.constrained = {3};
  former.constrained_count = 1;
  return former;
}

TEST(FormerTypes, HealthIsReadUnderItsNewNames) {
  health_t health;
  ASSERT_TRUE(read(former_health(), health));
  expect_stamped(health);
  EXPECT_EQ(health.cycles, 7);
  EXPECT_EQ(health.gate_limited, 8);
  EXPECT_EQ(health.gate_rejected, 9);
  EXPECT_EQ(health.commands_rejected, 10);
  EXPECT_EQ(health.model_late[0], 11);
  EXPECT_EQ(health.reason[0], 'x');
}

TEST(FormerTypes, ShapesAreOneChunkOfCornerNodes) {
  shape_t shape;
  ASSERT_TRUE(read(former_shape(), shape));
  expect_stamped(shape);
  EXPECT_EQ(shape.mesh_hash, 77);
  EXPECT_EQ(shape.status, shape_t::STATUS_NOT_CONVERGED);
  EXPECT_EQ(shape.age_us, 12);
  EXPECT_EQ(shape.chunk, 0);
  EXPECT_EQ(shape.chunks, 1);
  EXPECT_EQ(shape.first_node, 0);
  EXPECT_EQ(shape.node_count, 4);
  EXPECT_EQ(shape.xyz, former_shape().xyz);
  EXPECT_EQ(shape.xyz_count, 12);
  EXPECT_EQ(shape.deviation, former_shape().deviation);
  EXPECT_EQ(shape.deviation_count, 4);
}

TEST(FormerTypes, MeshesKeepTheirElementsOfCornerNodes) {
  shape_mesh_t mesh;
  ASSERT_TRUE(read(former_mesh(), mesh));
  expect_stamped(mesh);
  EXPECT_EQ(mesh.mesh_hash, 77);
  EXPECT_EQ(mesh.element_kind, shape_mesh_t::QUADRATIC_TETRAHEDRA);
  EXPECT_EQ(mesh.element_size, 4);
  EXPECT_EQ(mesh.chunk, 0);
  EXPECT_EQ(mesh.chunks, 1);
  EXPECT_EQ(mesh.node_count, 4);
  EXPECT_EQ(mesh.rest_xyz, former_mesh().rest_xyz);
  EXPECT_EQ(mesh.elements, former_mesh().elements);
  EXPECT_EQ(mesh.triangles, former_mesh().triangles);
  EXPECT_EQ(mesh.constrained, former_mesh().constrained);
  EXPECT_EQ(mesh.rest_xyz_count, 12);
  EXPECT_EQ(mesh.element_index_count, 4);
  EXPECT_EQ(mesh.triangle_index_count, 3);
  EXPECT_EQ(mesh.constrained_count, 1);
}

TEST(FormerTypes, OtherTypesAreNotDecoded) {
  shape_t shape;
  EXPECT_FALSE(read(former_mesh(), shape));
  health_t health;
  EXPECT_FALSE(read(stamped<imu_t>(), health));
  const shape_v1_t former = former_shape();
  std::vector<std::uint8_t> data(static_cast<std::size_t>(former.getEncodedSize()));
  former.encode(data.data(), 0, static_cast<int>(data.size()));
  EXPECT_TRUE(decode(shape, data.data(), static_cast<int>(data.size())));
  EXPECT_FALSE(decode(shape, data.data(), static_cast<int>(data.size()) - 4));
}

TEST(FormerTypes, AFormerLogIsReadAsAWhole) {
  const support::ScratchFolder scratch;
  const std::filesystem::path path = scratch.path() / "former.log";
  {
    EventLog log(path);
    log.write("SHAPE_MESH", 1, former_mesh());
    log.write("SHAPE", 2, former_shape());
    log.write("HEALTH", 3, former_health());
  }
  const RunLog run = read_run(path, path);
  const MeshMessage mesh = assemble(run.shape_chunks);
  EXPECT_EQ(mesh.nodes.cols(), 4);
  ASSERT_EQ(run.shapes.size(), 1U);
  EXPECT_EQ(run.shapes[0].utime, 2) << "time of the log";
  EXPECT_EQ(positions(run.shapes[0]), mesh.nodes);
  ASSERT_EQ(run.health.size(), 1U);
  EXPECT_EQ(run.health[0].gate_rejected, 9);
}

}  // namespace
}  // namespace palpate::log
