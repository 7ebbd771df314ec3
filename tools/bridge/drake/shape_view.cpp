#include "shape_view.hpp"

#include <cmath>
#include <palpate/channels.hpp>

#include "rt/bus/checked_decode.hpp"

namespace palpate::drake_bridge {
namespace {

constexpr std::int8_t kTriangles = 4;  // lcmt_viewer_geometry_data.type

}  // namespace

ShapeView::ShapeView(const Options& options) : options_(options) {
  message_.name = "palpate";
  message_.num_geom = 1;
  message_.geom.resize(1);
  ::drake::lcmt_viewer_geometry_data& geometry = message_.geom[0];
  geometry.type = kTriangles;
  geometry.string_data = "shape";
  double quaternion[4];
  math::wxyz_from_rotation(options.X_WO.linear(), quaternion);
  for (int i = 0; i < 3; ++i)
    geometry.position[i] = static_cast<float>(options.X_WO.translation()[i]);
  for (int i = 0; i < 4; ++i) {
    geometry.quaternion[i] = static_cast<float>(quaternion[i]);
    geometry.color[i] = static_cast<float>(options.color[i]);
  }
}

/// Counts and triangles, after room for the vertices.
void ShapeView::number(const shape_mesh_t& mesh) {
  std::vector<int> vertices(mesh.node_count, -1);
  nodes_.clear();
  for (const std::int32_t node : mesh.triangles) {
    if (vertices[node] >= 0) continue;
    vertices[node] = static_cast<int>(nodes_.size());
    nodes_.push_back(node);
  }
  std::vector<float>& numbers = message_.geom[0].float_data;
  numbers.assign(2 + 3 * nodes_.size(), 0);
  numbers[0] = static_cast<float>(nodes_.size());
  numbers[1] = static_cast<float>(mesh.triangles.size() / 3);
  for (const std::int32_t node : mesh.triangles)
    numbers.push_back(static_cast<float>(vertices[node]));
  message_.geom[0].num_float_data = static_cast<std::int32_t>(numbers.size());
  mesh_hash_ = mesh.mesh_hash;
  node_count_ = mesh.node_count;
  has_mesh_ = true;
}

bool ShapeView::draw(const shape_t& shape) {
  if (!has_mesh_ || shape.mesh_hash != mesh_hash_) {
    const auto mesh = meshes_.find(shape.mesh_hash);
    if (!mesh) return false;
    number(*mesh);
  }
  if (shape.node_count != node_count_) return false;
  std::vector<float>& numbers = message_.geom[0].float_data;
  std::size_t place = 2;
  for (const std::int32_t node : nodes_)
    for (int i = 0; i < 3; ++i, ++place) {
      numbers[place] = shape.xyz[3 * node + i];
      if (!std::isfinite(numbers[place])) return false;
    }
  return true;
}

bool ShapeView::take(std::string_view channel, const void* data, int size, std::int64_t utime) {
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
  if (has_drawn_ && static_cast<double>(utime - drawn_us_) * options_.rate < 1e6) return false;
  if (!draw(*shape)) return false;
  has_drawn_ = true;
  drawn_us_ = utime;
  return true;
}

}  // namespace palpate::drake_bridge
