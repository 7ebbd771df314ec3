#include "surface.hpp"

#include <cmath>
#include <palpate/channels.hpp>

#include "rt/bus/checked_decode.hpp"

namespace palpate::bridge {

void Surface::number(const shape_mesh_t& mesh) {
  std::vector<std::int32_t> vertices(mesh.node_count, -1);
  nodes_.clear();
  triangles_.clear();
  for (const std::int32_t node : mesh.triangles) {
    if (vertices[node] < 0) {
      vertices[node] = static_cast<std::int32_t>(nodes_.size());
      nodes_.push_back(node);
    }
    triangles_.push_back(vertices[node]);
  }
  vertices_.assign(3 * nodes_.size(), 0);
  mesh_hash_ = mesh.mesh_hash;
  node_count_ = mesh.node_count;
  has_mesh_ = true;
}

bool Surface::draw(const shape_t& shape) {
  if (!has_mesh_ || shape.mesh_hash != mesh_hash_) {
    const auto mesh = meshes_.find(shape.mesh_hash);
    if (!mesh) return false;
    number(*mesh);
  }
  if (shape.node_count != node_count_) return false;
  std::size_t place = 0;
  for (const std::int32_t node : nodes_)
    for (int i = 0; i < 3; ++i, ++place) {
      vertices_[place] = shape.xyz[3 * node + i];
      if (!std::isfinite(vertices_[place])) return false;
    }
  utime_ = shape.utime;
  return true;
}

bool Surface::take(std::string_view channel, const void* data, int size, std::int64_t utime) {
  if (channel == channel::kShapeMesh) {
    shape_mesh_t chunk;
    if (bus::checked_decode(chunk, data, size)) meshes_.add(chunk);
    return false;
  }
  if (channel != channel::kShape) return false;
  shape_t chunk;
  if (!bus::checked_decode(chunk, data, size)) return false;
  const shape_t* const shape = shapes_.add(std::move(chunk));
  if (shape == nullptr) return false;
  if (has_drawn_ && static_cast<double>(utime - drawn_us_) * rate_ < 1e6) return false;
  if (!draw(*shape)) return false;
  has_drawn_ = true;
  drawn_us_ = utime;
  return true;
}

}  // namespace palpate::bridge
