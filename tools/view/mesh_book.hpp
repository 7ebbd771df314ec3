#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <palpate/shape_mesh_t.hpp>
#include <vector>

namespace palpate::view {

/// A whole mesh as SHAPE_MESH or TRUTH_MESH describe it; every index lies within it.
struct ViewMesh {
  std::int64_t hash = 0;
  int element_kind = 0;  // of shape_mesh_t
  int element_size = 0;  // nodes of an element
  int node_count = 0;
  std::vector<float> rest_xyz;  // m, in O
  std::vector<std::int32_t> elements, triangles, constrained;
};

/// Puts meshes together from their chunks, which come in any order, more than once, or not at all,
/// and may hold anything.
class MeshBook {
 public:
  /// Nodes and chunks that a mesh may have.
  static constexpr int kMostNodes = 200'000, kMostChunks = 1'000;

  /// True where this chunk was the last one that its mesh lacked. A chunk that does not fit those
  /// before, or itself, is refused and counted.
  bool add(const shape_mesh_t& chunk);

  /// nullptr where the mesh is not (wholly) known.
  std::shared_ptr<const ViewMesh> find(std::int64_t hash) const;

  std::int64_t refused() const { return refused_; }

 private:
  struct Entry {
    std::vector<std::shared_ptr<const shape_mesh_t>> chunks;
    int missing = 0;
    std::shared_ptr<const ViewMesh> mesh;
    std::int64_t last_use = 0;
  };
  void forget_oldest();

  std::map<std::int64_t, Entry> entries_;
  std::int64_t uses_ = 0;
  std::int64_t refused_ = 0;
};

}  // namespace palpate::view
