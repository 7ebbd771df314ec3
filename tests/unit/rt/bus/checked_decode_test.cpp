#include "rt/bus/checked_decode.hpp"

#include <gtest/gtest.h>

#include <palpate/contacts_v1_t.hpp>
#include <palpate/ft_wrench_t.hpp>
#include <palpate/health_v1_t.hpp>
#include <palpate/imu_t.hpp>
#include <vector>

#include "tests/unit/rt/bus/messages.hpp"

namespace palpate::bus {
namespace {

using wire::encoded;

shape_mesh_t mesh() {
  shape_mesh_t mesh{};
  mesh.rest_xyz = {1, 2, 3, 4, 5, 6};
  mesh.rest_xyz_count = 6;
  mesh.element_size = 4;
  mesh.elements = {0, 1, 2, 3};
  mesh.element_index_count = 4;
  mesh.triangles = {0, 1, 2};
  mesh.triangle_index_count = 3;
  mesh.constrained = {1};
  mesh.constrained_count = 1;
  return mesh;
}

template <class Message>
bool decodes(const std::vector<std::uint8_t>& bytes) {
  Message message{};
  return checked_decode(message, bytes.data(), static_cast<int>(bytes.size()));
}

TEST(CheckedDecode, GivesBackWholeMessages) {
  shape_mesh_t back{};
  const std::vector<std::uint8_t> bytes = encoded(mesh());
  ASSERT_TRUE(checked_decode(back, bytes.data(), static_cast<int>(bytes.size())));
  EXPECT_EQ(encoded(back), bytes);
  shape_t shape{};
  shape.xyz = {1, 2, 3};
  shape.xyz_count = 3;
  shape.deviation = {4};
  shape.deviation_count = 1;
  EXPECT_TRUE(decodes<shape_t>(encoded(shape)));
  EXPECT_TRUE(decodes<shape_t>(encoded(shape_t{})));
  EXPECT_TRUE(decodes<ft_wrench_t>(encoded(ft_wrench_t{})));
}

TEST(CheckedDecode, RefusesEveryOtherSizeAndType) {
  std::vector<std::uint8_t> bytes = encoded(mesh());
  bytes.push_back(0);
  EXPECT_FALSE(decodes<shape_mesh_t>(bytes));
  for (bytes.pop_back(); !bytes.empty();) {
    bytes.pop_back();
    EXPECT_FALSE(decodes<shape_mesh_t>(bytes)) << bytes.size();
  }
  EXPECT_FALSE(decodes<ft_wrench_t>(encoded(shape_t{})));
  EXPECT_FALSE(decodes<shape_t>(encoded(ft_wrench_t{})));
}

TEST(CheckedDecode, RefusesCountsThatTheMessageDoesNotHold) {
  const std::vector<std::uint8_t> good = encoded(mesh());
  // The size of 2^30 numbers of 4 bytes does not fit an int, and -1 has no size.
  for (const std::uint8_t first : {0x40, 0x20, 0xff, 0x80, 0x7f}) {
    for (const std::size_t place : {52u, 52u + 4 + 24 + 4, 52u + 4 + 24 + 4 + 4 + 16}) {
      std::vector<std::uint8_t> bad = good;
      bad[place] = first;
      EXPECT_FALSE(decodes<shape_mesh_t>(bad)) << place;
    }
  }
}

const std::vector<float> kCorners = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};  // of a tetrahedron

template <class Message>
Message stamped() {
  Message message{};
  message.utime = 1234;
  message.seq = 5;
  message.session = 6;
  return message;
}

/// Sets a list of a message and its length.
template <class List>
void put(List& list, std::int32_t& count, const List& content) {
  list = content;
  count = static_cast<std::int32_t>(content.size());
}

template <class Into>
bool decodes(const std::vector<std::uint8_t>& data, Into& into) {
  return decode(into, data.data(), static_cast<int>(data.size()));
}

template <class Message>
void expect_stamped(const Message& message) {
  EXPECT_EQ(message.utime, 1234);
  EXPECT_EQ(message.seq, 5);
  EXPECT_EQ(message.session, 6);
}

template <class List>
void expect_list(const List& list, std::int32_t count, const List& expected) {
  EXPECT_EQ(list, expected);
  EXPECT_EQ(count, static_cast<std::int32_t>(expected.size()));
}

contacts_v1_t former_contacts() {
  auto former = stamped<contacts_v1_t>();
  former.count = 8;
  for (int i = 0; i < 8; ++i) {
    former.source[i] = i;
    former.location[i][2] = 10 + i;
    former.wrench[i][5] = 20 + i;
    former.deviation[i] = 30 + i;
  }
  return former;
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
  put(former.xyz, former.xyz_count, kCorners);
  put(former.deviation, former.deviation_count, {1, 2, 3, 4});
  return former;
}

shape_mesh_v1_t former_mesh() {
  auto former = stamped<shape_mesh_v1_t>();
  former.mesh_hash = 77;
  former.element_kind = shape_mesh_t::QUADRATIC_TETRAHEDRA;
  former.chunks = 1;
  former.corner_count = 4;
  put(former.rest_xyz, former.rest_xyz_count, kCorners);
  former.element_size = 4;
  put(former.elements, former.element_index_count, {0, 1, 2, 3});
  put(former.triangles, former.triangle_index_count, {0, 2, 1});
  put(former.constrained, former.constrained_count, {3});
  return former;
}

TEST(FormerTypes, ContactsAreReadWithoutPredictedOnes) {
  contacts_t contacts;
  contacts.predicted_count = 3;
  ASSERT_TRUE(decodes(encoded(former_contacts()), contacts));
  expect_stamped(contacts);
  EXPECT_EQ(contacts.count, 8);
  for (int i = 0; i < 8; ++i) {
    EXPECT_EQ(contacts.source[i], i);
    EXPECT_EQ(contacts.location[i][2], 10 + i);
    EXPECT_EQ(contacts.wrench[i][5], 20 + i);
    EXPECT_EQ(contacts.deviation[i], 30 + i);
  }
  EXPECT_EQ(contacts.predicted_count, 0);
  EXPECT_EQ(contacts.obstacle_count, 0);
}

TEST(FormerTypes, HealthIsReadUnderItsNewNames) {
  health_t health;
  ASSERT_TRUE(decodes(encoded(former_health()), health));
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
  ASSERT_TRUE(decodes(encoded(former_shape()), shape));
  expect_stamped(shape);
  EXPECT_EQ(shape.mesh_hash, 77);
  EXPECT_EQ(shape.status, shape_t::STATUS_NOT_CONVERGED);
  EXPECT_EQ(shape.age_us, 12);
  EXPECT_EQ(shape.chunk, 0);
  EXPECT_EQ(shape.chunks, 1);
  EXPECT_EQ(shape.first_node, 0);
  EXPECT_EQ(shape.node_count, 4);
  expect_list(shape.xyz, shape.xyz_count, kCorners);
  expect_list(shape.deviation, shape.deviation_count, {1, 2, 3, 4});
}

TEST(FormerTypes, MeshesKeepTheirElementsOfCornerNodes) {
  shape_mesh_t mesh;
  ASSERT_TRUE(decodes(encoded(former_mesh()), mesh));
  expect_stamped(mesh);
  EXPECT_EQ(mesh.mesh_hash, 77);
  EXPECT_EQ(mesh.element_kind, shape_mesh_t::QUADRATIC_TETRAHEDRA);
  EXPECT_EQ(mesh.element_size, 4);
  EXPECT_EQ(mesh.chunk, 0);
  EXPECT_EQ(mesh.chunks, 1);
  EXPECT_EQ(mesh.node_count, 4);
  expect_list(mesh.rest_xyz, mesh.rest_xyz_count, kCorners);
  expect_list(mesh.elements, mesh.element_index_count, {0, 1, 2, 3});
  expect_list(mesh.triangles, mesh.triangle_index_count, {0, 2, 1});
  expect_list(mesh.constrained, mesh.constrained_count, {3});
}

TEST(FormerTypes, OtherTypesAreNotDecoded) {
  shape_t shape;
  EXPECT_FALSE(decodes(encoded(former_mesh()), shape));
  health_t health;
  EXPECT_FALSE(decodes(encoded(stamped<imu_t>()), health));
  std::vector<std::uint8_t> data = encoded(former_shape());
  EXPECT_TRUE(decodes(data, shape));
  data.resize(data.size() - 4);
  EXPECT_FALSE(decodes(data, shape));
}

}  // namespace
}  // namespace palpate::bus
