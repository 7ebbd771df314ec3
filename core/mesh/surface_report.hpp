#pragma once

#include <array>
#include <utility>
#include <vector>

#include "core/mesh/connectivity.hpp"
#include "core/mesh/triangle_surface.hpp"

namespace palpate::mesh {

/// Pairs of triangles that meet elsewhere than in shared corners and edges: self-intersections and
/// overlaps of the surface. Triangles without area are ignored. All indices must be in range and
/// coordinates finite.
std::vector<std::pair<int, int>> find_intersections(const TriangleSurface& surface);

/// Faults of a surface that bounds a body. Lists contain 0-based indices. Where an index or a
/// coordinate is invalid, dependent checks are skipped.
struct SurfaceReport {
  int point_count = 0;
  int triangle_count = 0;

  std::vector<int> index_out_of_range;  // triangles
  std::vector<int> not_finite;          // points
  std::vector<int> no_area;             // triangles: height below 1e-9 of the longest edge
  std::vector<int> repeated;            // triangles with the same corners as an earlier one
  std::vector<int> duplicate_points;    // points nearer to another than 1e-9 of the surface's size
  std::vector<int> unused_points;
  std::vector<std::vector<int>> holes;   // loop of points around each, in the order of the rim
  std::vector<Edge> non_manifold_edges;  // edges of more than two triangles
  std::vector<int> non_manifold_points;  // points whose triangles form more than one fan
  std::vector<int> turned;               // triangles oriented against their neighbours
  std::vector<int> one_sided;            // non-orientable parts (Moebius)
  std::vector<int> inside_out;           // parts oriented inward
  std::vector<std::pair<int, int>> intersections;  // pairs of triangles
  std::vector<int> part;                           // part of each triangle, connected by edges
  /// For each part: number of other closed parts that contain it; odd: a cavity.
  std::vector<int> depth;
  int bodies = 0;  // closed parts of even depth

  double area = 0;    // m^2
  double volume = 0;  // m^3, with parts oriented correctly; 0 if there are holes

  int parts() const { return static_cast<int>(depth.size()); }
  bool is_closed() const { return holes.empty() && non_manifold_edges.empty(); }
  /// True if the surface bounds one body that can be meshed with tetrahedra.
  bool ok() const;
};

SurfaceReport check(const TriangleSurface& surface);

}  // namespace palpate::mesh
