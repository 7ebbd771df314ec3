#include "rt/bus/shape_chunks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "rt/bus/checked_decode.hpp"
#include "tests/support/box_mesh.hpp"

namespace palpate::bus {
namespace {

using support::box_mesh;

TEST(MeshChunks, FitDatagramsAndMakeTheMeshWholeInAnyOrder) {
  const shape_mesh_t whole = box_mesh({40, 12, 12});
  std::vector<shape_mesh_t> chunks = split(whole);
  ASSERT_GT(chunks.size(), 3U);
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    EXPECT_LT(chunks[i].getEncodedSize(), 60'000);
    EXPECT_EQ(chunks[i].chunk, static_cast<int>(i));
    EXPECT_EQ(chunks[i].chunks, static_cast<int>(chunks.size()));
    EXPECT_EQ(chunks[i].mesh_hash, 77);
    EXPECT_EQ(chunks[i].element_index_count % 4, 0);
  }
  MeshAssembler assembler;
  EXPECT_FALSE(assembler.add(chunks[1]));
  EXPECT_FALSE(assembler.add(chunks[1])) << "twice the same";
  for (std::size_t i = chunks.size() - 1; i > 1; --i) EXPECT_FALSE(assembler.add(chunks[i]));
  EXPECT_EQ(assembler.find(77), nullptr);
  EXPECT_TRUE(assembler.add(chunks[0]));
  const auto mesh = assembler.find(77);
  ASSERT_NE(mesh, nullptr);
  EXPECT_EQ(mesh->chunk, 0);
  EXPECT_EQ(mesh->chunks, 1);
  EXPECT_EQ(mesh->first_node, 0);
  EXPECT_EQ(mesh->rest_xyz, whole.rest_xyz);
  EXPECT_EQ(mesh->elements, whole.elements);
  EXPECT_EQ(mesh->triangles, whole.triangles);
  EXPECT_EQ(mesh->constrained, whole.constrained);
  EXPECT_EQ(mesh->rest_xyz_count, whole.rest_xyz_count);
  EXPECT_EQ(mesh->triangle_index_count, whole.triangle_index_count);
  EXPECT_EQ(assembler.rejected(), 0);
}

TEST(MeshChunks, OfASmallMeshAreOne) {
  const std::vector<shape_mesh_t> chunks = split(box_mesh({2, 1, 1}));
  ASSERT_EQ(chunks.size(), 1U);
  EXPECT_EQ(chunks[0].first_node, 0);
  EXPECT_EQ(chunks[0].rest_xyz, box_mesh({2, 1, 1}).rest_xyz);
}

TEST(MeshChunks, ThatDoNotFitAreRejected) {
  const shape_mesh_t good = box_mesh({2, 1, 1});
  const auto rejected = [&](auto spoil) {
    MeshAssembler assembler;
    shape_mesh_t bad = good;
    spoil(bad);
    assembler.add(bad);
    return assembler.rejected() == 1 && assembler.find(77) == nullptr;
  };
  EXPECT_FALSE(rejected([](shape_mesh_t&) {}));
  EXPECT_TRUE(rejected([](shape_mesh_t& m) { m.triangles[4] = m.node_count; }));
  EXPECT_TRUE(rejected([](shape_mesh_t& m) { m.elements[4] = -1; }));
  EXPECT_TRUE(rejected([](shape_mesh_t& m) { m.constrained[0] = 1 << 30; }));
  EXPECT_TRUE(rejected([](shape_mesh_t& m) { m.rest_xyz[3] = std::nanf(""); }));
  EXPECT_TRUE(rejected([](shape_mesh_t& m) { m.rest_xyz.pop_back(); }));
  EXPECT_TRUE(rejected([](shape_mesh_t& m) { m.first_node = 1; }));
  EXPECT_TRUE(rejected([](shape_mesh_t& m) { m.first_node = std::numeric_limits<int>::max(); }));
  EXPECT_TRUE(rejected([](shape_mesh_t& m) { m.node_count = 2'000'000'000; }));
  EXPECT_TRUE(rejected([](shape_mesh_t& m) { m.chunk = 1; }));
  EXPECT_TRUE(rejected([](shape_mesh_t& m) { m.chunks = 0; }));
  EXPECT_TRUE(rejected([](shape_mesh_t& m) { m.element_size = 0; }));
  EXPECT_TRUE(rejected([](shape_mesh_t& m) { m.node_count += 1; })) << "a node is missing";
}

TEST(MeshChunks, OnlyAFewMeshesAreKept) {
  MeshAssembler assembler;
  shape_mesh_t mesh = box_mesh({1, 1, 1});
  for (int i = 0; i < 100; ++i) {
    mesh.mesh_hash = i;
    EXPECT_TRUE(assembler.add(mesh));
  }
  EXPECT_NE(assembler.find(99), nullptr);
  EXPECT_EQ(assembler.find(0), nullptr);
}

/// Publishes shapes of `nodes` nodes, and decodes what was sent.
class ShapeChunks : public testing::Test {
 protected:
  std::vector<shape_t> published(int nodes, bool with_deviation, std::int64_t utime = 100) {
    xyz_.resize(static_cast<std::size_t>(3 * nodes));
    deviation_.resize(static_cast<std::size_t>(nodes));
    for (std::size_t i = 0; i < xyz_.size(); ++i) xyz_[i] = 0.1 * static_cast<double>(i) - 7;
    for (std::size_t i = 0; i < deviation_.size(); ++i)
      deviation_[i] = 1e-3F * static_cast<float>(i);
    const auto hub = make_memory_hub();
    const auto bus = make_memory_bus(hub);
    std::vector<Published> messages;
    record(*hub, &messages);
    ShapePublisher publisher(*bus, "SHAPE", Urgency::kLater, 77, nodes);
    publisher.publish({xyz_.data(), with_deviation ? deviation_.data() : nullptr,
                       shape_t::STATUS_NOT_CONVERGED, 1234},
                      stamp_, utime);
    std::vector<shape_t> chunks;
    for (const Published& one : messages) {
      EXPECT_LT(one.data.size(), 60'000U);
      chunks.emplace_back();
      EXPECT_TRUE(
          checked_decode(chunks.back(), one.data.data(), static_cast<int>(one.data.size())));
      // byte by byte what the generated code would write
      std::vector<std::uint8_t> again(static_cast<std::size_t>(chunks.back().getEncodedSize()));
      chunks.back().encode(again.data(), 0, static_cast<int>(again.size()));
      EXPECT_EQ(again, one.data);
    }
    return chunks;
  }
  void expect_whole(const shape_t* shape, bool with_deviation) {
    ASSERT_NE(shape, nullptr);
    EXPECT_EQ(shape->chunk, 0);
    EXPECT_EQ(shape->chunks, 1);
    EXPECT_EQ(shape->first_node, 0);
    EXPECT_EQ(shape->mesh_hash, 77);
    EXPECT_EQ(shape->status, shape_t::STATUS_NOT_CONVERGED);
    EXPECT_EQ(shape->age_us, 1234);
    EXPECT_EQ(shape->xyz, std::vector<float>(xyz_.begin(), xyz_.end()));
    EXPECT_EQ(shape->xyz_count, 3 * shape->node_count);
    EXPECT_EQ(shape->deviation, with_deviation ? deviation_ : std::vector<float>());
    EXPECT_EQ(shape->deviation_count, static_cast<int>(shape->deviation.size()));
  }

  HeaderStamper stamp_{5};
  std::vector<double> xyz_;
  std::vector<float> deviation_;
};

TEST_F(ShapeChunks, ASmallShapeIsOneMessage) {
  for (const bool with_deviation : {true, false}) {
    std::vector<shape_t> chunks = published(300, with_deviation);
    ASSERT_EQ(chunks.size(), 1U);
    EXPECT_EQ(chunks[0].session, 5);
    EXPECT_EQ(chunks[0].utime, 100);
    ShapeAssembler assembler;
    expect_whole(assembler.add(std::move(chunks[0])), with_deviation);
  }
}

TEST_F(ShapeChunks, ALargeShapeIsJoinedInAnyOrder) {
  for (const bool with_deviation : {true, false}) {
    std::vector<shape_t> chunks = published(10'001, with_deviation);
    ASSERT_EQ(chunks.size(), 3U);
    EXPECT_EQ(chunks[2].seq, chunks[0].seq + 2);
    std::sort(chunks.begin(), chunks.end(),
              [](const shape_t& a, const shape_t& b) { return a.xyz_count < b.xyz_count; });
    ShapeAssembler assembler;
    EXPECT_EQ(assembler.add(shape_t(chunks[0])), nullptr);
    EXPECT_EQ(assembler.add(shape_t(chunks[0])), nullptr) << "twice the same";
    EXPECT_EQ(assembler.add(shape_t(chunks[1])), nullptr);
    expect_whole(assembler.add(shape_t(chunks[2])), with_deviation);
    EXPECT_EQ(assembler.rejected(), 0);
  }
}

TEST_F(ShapeChunks, AShapeWithALostChunkIsSkipped) {
  const std::vector<shape_t> first = published(10'001, true, 100);
  ShapeAssembler assembler;
  assembler.add(shape_t(first[0]));
  for (std::int64_t utime = 200; utime < 1000; utime += 100) {
    const std::vector<shape_t> next = published(10'001, true, utime);
    EXPECT_EQ(assembler.add(shape_t(next[0])), nullptr);
    EXPECT_EQ(assembler.add(shape_t(next[1])), nullptr);
    const shape_t* shape = assembler.add(shape_t(next[2]));
    ASSERT_NE(shape, nullptr);
    EXPECT_EQ(shape->utime, utime);
  }
  EXPECT_EQ(assembler.add(shape_t(first[1])), nullptr);
  EXPECT_EQ(assembler.add(shape_t(first[2])), nullptr) << "its first chunk was given up";
}

TEST_F(ShapeChunks, ThatDoNotFitAreRejected) {
  const std::vector<shape_t> good = published(10'001, true);
  const auto rejected = [&](auto spoil) {
    ShapeAssembler assembler;
    assembler.add(shape_t(good[0]));
    shape_t bad = good[1];
    spoil(bad);
    const shape_t* shape = assembler.add(std::move(bad));
    if (shape == nullptr) shape = assembler.add(shape_t(good[2]));
    return assembler.rejected() == 1 && shape == nullptr;
  };
  EXPECT_FALSE(rejected([](shape_t&) {}));
  EXPECT_TRUE(rejected([](shape_t& m) { m.chunk = 3; }));
  EXPECT_TRUE(rejected([](shape_t& m) { m.chunk = -1; }));
  EXPECT_TRUE(rejected([](shape_t& m) { m.chunks = 0; }));
  EXPECT_TRUE(rejected([](shape_t& m) { m.chunks = 4; }));
  EXPECT_TRUE(rejected([](shape_t& m) { m.chunks = 30'000; }));
  EXPECT_TRUE(rejected([](shape_t& m) { m.node_count += 1; }));
  EXPECT_TRUE(rejected([](shape_t& m) { m.node_count = 2'000'000'000; }));
  EXPECT_TRUE(rejected([](shape_t& m) { m.first_node = -1; }));
  EXPECT_TRUE(rejected([](shape_t& m) { m.first_node = 10'000; }));
  EXPECT_TRUE(rejected([](shape_t& m) { m.mesh_hash = 78; }));
  EXPECT_TRUE(rejected([](shape_t& m) { m.xyz.pop_back(); }));
  EXPECT_TRUE(rejected([](shape_t& m) { m.deviation.pop_back(); }));
  EXPECT_TRUE(rejected([](shape_t& m) { m.xyz.resize(30), m.deviation.resize(10); }))
      << "nodes are missing";
  ShapeAssembler assembler;
  shape_t alone = good[0];
  alone.chunks = 1;
  EXPECT_EQ(assembler.add(std::move(alone)), nullptr);
  EXPECT_EQ(assembler.rejected(), 1);
}

}  // namespace
}  // namespace palpate::bus
