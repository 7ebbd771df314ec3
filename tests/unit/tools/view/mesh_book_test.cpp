#include "tools/view/mesh_book.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/unit/tools/view/shapes.hpp"

namespace palpate::view {
namespace {

TEST(MeshBook, PutsChunksTogetherInAnyOrder) {
  const auto chunks = box_chunks({4, 2, 2}, 3);
  MeshBook book;
  EXPECT_FALSE(book.add(chunks[2]));
  EXPECT_FALSE(book.add(chunks[2])) << "twice the same";
  EXPECT_FALSE(book.add(chunks[0]));
  EXPECT_EQ(book.find(77), nullptr);
  EXPECT_TRUE(book.add(chunks[1]));
  const auto mesh = book.find(77);
  ASSERT_NE(mesh, nullptr);
  const auto whole = box_chunks({4, 2, 2})[0];
  EXPECT_EQ(mesh->rest_xyz, whole.rest_xyz);
  EXPECT_EQ(mesh->elements, whole.elements);
  EXPECT_EQ(mesh->triangles, whole.triangles);
  EXPECT_EQ(mesh->constrained, whole.constrained);
  EXPECT_EQ(book.refused(), 0);
}

TEST(MeshBook, RefusesWhatDoesNotFit) {
  const shape_mesh_t good = box_chunks({2, 1, 1})[0];
  const auto refused = [&](auto spoil) {
    MeshBook book;
    shape_mesh_t bad = good;
    spoil(bad);
    book.add(bad);
    return book.refused() == 1 && book.find(77) == nullptr;
  };
  EXPECT_TRUE(refused([](shape_mesh_t& m) { m.triangles[4] = m.corner_count; }));
  EXPECT_TRUE(refused([](shape_mesh_t& m) { m.elements[4] = -1; }));
  EXPECT_TRUE(refused([](shape_mesh_t& m) { m.constrained[0] = 1 << 30; }));
  EXPECT_TRUE(refused([](shape_mesh_t& m) { m.rest_xyz[3] = std::nanf(""); }));
  EXPECT_TRUE(refused([](shape_mesh_t& m) { m.rest_xyz.pop_back(); }));
  EXPECT_TRUE(refused([](shape_mesh_t& m) { m.first_node = 1; }));
  EXPECT_TRUE(refused([](shape_mesh_t& m) { m.first_node = std::numeric_limits<int>::max(); }));
  EXPECT_TRUE(refused([](shape_mesh_t& m) { m.corner_count = 2'000'000'000; }));
  EXPECT_TRUE(refused([](shape_mesh_t& m) { m.chunk = 1; }));
  EXPECT_TRUE(refused([](shape_mesh_t& m) { m.chunks = 0; }));
  EXPECT_TRUE(refused([](shape_mesh_t& m) { m.element_size = 0; }));
  EXPECT_TRUE(refused([](shape_mesh_t& m) { m.corner_count += 1; })) << "a node is missing";
}

TEST(MeshBook, KeepsOnlyAFewMeshes) {
  MeshBook book;
  shape_mesh_t mesh = box_chunks({1, 1, 1})[0];
  for (int i = 0; i < 100; ++i) {
    mesh.mesh_hash = i;
    EXPECT_TRUE(book.add(mesh));
  }
  EXPECT_NE(book.find(99), nullptr);
  EXPECT_EQ(book.find(0), nullptr);
}

}  // namespace
}  // namespace palpate::view
