#include "tools/view/mesh_book.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::view {
namespace {

constexpr std::size_t kMostMeshes = 8;

bool is_sound(const shape_mesh_t& chunk) {
  const bool counted = chunk.chunks >= 1 && chunk.chunks <= MeshBook::kMostChunks &&
                       chunk.chunk >= 0 && chunk.chunk < chunk.chunks && chunk.corner_count >= 1 &&
                       chunk.corner_count <= MeshBook::kMostNodes && chunk.element_size >= 1 &&
                       chunk.element_size <= 64;
  if (!counted || chunk.rest_xyz.size() % 3 != 0 || chunk.triangles.size() % 3 != 0 ||
      chunk.elements.size() % static_cast<std::size_t>(chunk.element_size) != 0)
    return false;
  const std::int64_t last =
      std::int64_t{chunk.first_node} + static_cast<std::int64_t>(chunk.rest_xyz.size() / 3);
  if (chunk.first_node < 0 || last > chunk.corner_count) return false;
  return std::all_of(chunk.rest_xyz.begin(), chunk.rest_xyz.end(),
                     [](float x) { return std::isfinite(x) && std::fabs(x) < 1e4F; });
}

bool within(const std::vector<std::int32_t>& indices, int count) {
  return std::all_of(indices.begin(), indices.end(),
                     [count](std::int32_t i) { return i >= 0 && i < count; });
}

template <class T>
void append(std::vector<T>& whole, const std::vector<T>& part) {
  whole.insert(whole.end(), part.begin(), part.end());
}

/// nullptr if nodes are missing or indices are out of range.
std::shared_ptr<const ViewMesh> assemble(
    const std::vector<std::shared_ptr<const shape_mesh_t>>& chunks) {
  const shape_mesh_t& first = *chunks.front();
  auto mesh = std::make_shared<ViewMesh>();
  mesh->hash = first.mesh_hash;
  mesh->element_kind = first.element_kind;
  mesh->element_size = first.element_size;
  mesh->node_count = first.corner_count;
  mesh->rest_xyz.resize(static_cast<std::size_t>(3) * first.corner_count);
  std::vector<bool> known(static_cast<std::size_t>(first.corner_count), false);
  for (const auto& chunk : chunks) {
    std::copy(chunk->rest_xyz.begin(), chunk->rest_xyz.end(),
              mesh->rest_xyz.begin() + std::ptrdiff_t{3} * chunk->first_node);
    std::fill_n(known.begin() + chunk->first_node, chunk->rest_xyz.size() / 3, true);
    append(mesh->elements, chunk->elements);
    append(mesh->triangles, chunk->triangles);
    append(mesh->constrained, chunk->constrained);
  }
  const int count = mesh->node_count;
  const bool whole = std::all_of(known.begin(), known.end(), [](bool k) { return k; }) &&
                     within(mesh->elements, count) && within(mesh->triangles, count) &&
                     within(mesh->constrained, count);
  return whole ? mesh : nullptr;
}

}  // namespace

bool MeshBook::add(const shape_mesh_t& chunk) {
  if (!is_sound(chunk)) return ++refused_, false;
  Entry& entry = entries_[chunk.mesh_hash];
  entry.last_use = ++uses_;
  if (entry.mesh) return false;
  if (entry.chunks.empty()) {
    entry.chunks.resize(static_cast<std::size_t>(chunk.chunks));
    entry.missing = chunk.chunks;
    forget_oldest();
  }
  const auto other = std::find_if(entry.chunks.begin(), entry.chunks.end(),
                                  [](const auto& c) { return c != nullptr; });
  if (chunk.chunks != static_cast<int>(entry.chunks.size()) ||
      (other != entry.chunks.end() && ((*other)->corner_count != chunk.corner_count ||
                                       (*other)->element_size != chunk.element_size ||
                                       (*other)->element_kind != chunk.element_kind)))
    return ++refused_, false;
  auto& place = entry.chunks[static_cast<std::size_t>(chunk.chunk)];
  if (place) return false;
  place = std::make_shared<const shape_mesh_t>(chunk);
  if (--entry.missing > 0) return false;
  entry.mesh = assemble(entry.chunks);
  if (!entry.mesh) {
    entries_.erase(chunk.mesh_hash);  // to be collected again
    return ++refused_, false;
  }
  entry.chunks.clear();
  return true;
}

std::shared_ptr<const ViewMesh> MeshBook::find(std::int64_t hash) const {
  const auto entry = entries_.find(hash);
  return entry == entries_.end() ? nullptr : entry->second.mesh;
}

void MeshBook::forget_oldest() {
  while (entries_.size() > kMostMeshes) {
    entries_.erase(std::min_element(entries_.begin(), entries_.end(), [](auto& a, auto& b) {
      return a.second.last_use < b.second.last_use;
    }));
  }
}

}  // namespace palpate::view
