#include "rt/bus/checked_decode.hpp"

#include <gtest/gtest.h>

#include <palpate/ft_wrench_t.hpp>
#include <vector>

namespace palpate::bus {
namespace {

template <class Message>
std::vector<std::uint8_t> encoded(const Message& message) {
  std::vector<std::uint8_t> bytes(message.getEncodedSize());
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

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

}  // namespace
}  // namespace palpate::bus
