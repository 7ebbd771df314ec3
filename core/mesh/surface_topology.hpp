#pragma once

#include <map>
#include <vector>

#include "core/mesh/connectivity.hpp"
#include "core/mesh/triangle_surface.hpp"

namespace palpate::mesh {

/// Relative orientation of the triangles of a surface.
struct SurfaceSides {
  std::vector<int> part;       // part of each triangle, connected by edges, from 0
  std::vector<bool> turned;    // triangles oriented against the majority of their part
  std::vector<int> one_sided;  // parts without a consistent orientation
};

/// Adjacency of triangles and edges. Indices must be in range; triangles with a repeated point are
/// ignored.
class SurfaceTopology {
 public:
  explicit SurfaceTopology(const TriangleSurface& surface);

  /// Triangles at each edge (points in ascending order).
  const std::map<Edge, std::vector<int>>& edges() const { return edges_; }

  /// Loops of points around holes: edges of a single triangle, in the direction of a triangle that
  /// would close the hole.
  std::vector<std::vector<int>> holes() const;
  /// Edges of more than two triangles.
  std::vector<Edge> crowded_edges() const;
  SurfaceSides sides() const;

 private:
  bool runs_along(int t, int from, int to) const;

  const TriangleSurface& surface_;
  std::map<Edge, std::vector<int>> edges_;
};

}  // namespace palpate::mesh
