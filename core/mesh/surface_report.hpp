#pragma once

#include <array>
#include <utility>
#include <vector>

#include "core/mesh/triangle_surface.hpp"

namespace palpate::mesh {

/// An edge by its points, the lower first.
using SurfaceEdge = std::pair<int, int>;

/// What is wrong with a surface that is to bound a body. Lists hold 0-based indices. Where an index
/// or a coordinate is bad, what depends on it is not looked at.
struct SurfaceReport {
  int point_count = 0;
  int triangle_count = 0;

  std::vector<int> index_out_of_range;  // triangles
  std::vector<int> not_finite;          // points
  std::vector<int> no_area;             // triangles: height below 1e-9 of the longest edge
  std::vector<int> repeated;            // triangles with the same corners as an earlier one
  std::vector<int> duplicate_points;    // within 1e-9 of the surface's size of another
  std::vector<int> unused_points;
  std::vector<std::vector<int>> holes;  // loops of points round each, in the order of the rim
  std::vector<SurfaceEdge> non_manifold_edges;     // of more than two triangles
  std::vector<int> non_manifold_points;            // whose triangles are more than one fan
  std::vector<int> turned;                         // triangles turned against their neighbours
  std::vector<int> one_sided;                      // parts that have no two sides (Moebius)
  std::vector<int> inside_out;                     // parts
  std::vector<std::pair<int, int>> intersections;  // triangles
  std::vector<int> part;                           // of each triangle: joined by edges
  std::vector<int> depth;  // of each part: how many other closed parts it lies in; odd: a cavity
  int bodies = 0;          // closed parts of even depth

  double area = 0;    // m^2
  double volume = 0;  // m^3, of parts as they should be turned; 0 where there are holes
  double shortest_edge = 0;
  double longest_edge = 0;

  int parts() const { return static_cast<int>(depth.size()); }
  bool is_closed() const { return holes.empty() && non_manifold_edges.empty(); }
  /// True where one body can be filled with tetrahedra.
  bool ok() const;
};

SurfaceReport check(const TriangleSurface& surface);

}  // namespace palpate::mesh
