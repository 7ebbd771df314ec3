#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <palpate/shape_mesh_t.hpp>
#include <vector>

namespace palpate::view {

/// A complete mesh as described by SHAPE_MESH or TRUTH_MESH; every index is in range.
struct ViewMesh {
  std::int64_t hash = 0;
  int element_kind = 0;  // of shape_mesh_t
  int element_size = 0;  // nodes of an element
  int node_count = 0;
  std::vector<float> rest_xyz;  // m, in O
  std::vector<std::int32_t> elements, triangles, constrained;
};

/// Assembles meshes from their chunks, which may arrive in any order, repeatedly, or not at all,
/// with arbitrary contents.
class MeshBook {
 public:
  /// Nodes and chunks that a mesh may have.
  static constexpr int kMostNodes = 200'000, kMostChunks = 1'000;

  /// True if this chunk completed its mesh. A chunk that is inconsistent in itself or with those
  /// before is rejected and counted.
  bool add(const shape_mesh_t& chunk);

  /// nullptr if the mesh is unknown or incomplete.
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
