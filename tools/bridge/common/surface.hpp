#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "rt/bus/shape_chunks.hpp"

namespace palpate::bridge {

/// The surface of palpated's SHAPE: its vertices, without the nodes inside, and its triangles.
class Surface {
 public:
  /// `rate`: 1/s, of shapes, at most.
  explicit Surface(double rate) : rate_(rate) {}

  /// Takes a message of palpated's housekeeping, of any channel and content. True if there is a new
  /// shape, all of which is finite. `utime`: us, of any clock.
  bool take(std::string_view channel, const void* data, int size, std::int64_t utime);

  /// 3 coordinates of each vertex in O, m.
  const std::vector<float>& vertices() const { return vertices_; }
  /// 3 vertices of each triangle, oriented outward.
  const std::vector<std::int32_t>& triangles() const { return triangles_; }
  std::int64_t utime() const { return utime_; }  // of SHAPE, us

 private:
  bool draw(const shape_t& shape);
  void number(const shape_mesh_t& mesh);

  double rate_;
  bus::MeshAssembler meshes_;
  bus::ShapeAssembler shapes_;
  std::int64_t mesh_hash_ = 0, node_count_ = 0;
  bool has_mesh_ = false;
  std::vector<std::int32_t> nodes_;  // of the vertices
  std::vector<float> vertices_;
  std::vector<std::int32_t> triangles_;
  std::int64_t utime_ = 0, drawn_us_ = 0;
  bool has_drawn_ = false;
};

}  // namespace palpate::bridge
