#pragma once

#include <map>
#include <utility>
#include <vector>

#include "core/mesh/triangle_surface.hpp"

namespace palpate::mesh {

/// How the triangles of a surface are turned among each other.
struct SurfaceSides {
  std::vector<int> part;       // of each triangle, joined by edges, from 0
  std::vector<bool> turned;    // triangles that face the other way than most of their part
  std::vector<int> one_sided;  // parts in which no order fits all edges
};

/// Which triangles meet in which edges. Indices must be in range; triangles that name a point twice
/// are passed over.
class SurfaceTopology {
 public:
  explicit SurfaceTopology(const TriangleSurface& surface);

  /// Triangles at each edge (points in rising order).
  const std::map<std::pair<int, int>, std::vector<int>>& edges() const { return edges_; }

  /// Loops of points round holes: edges of one triangle, in the direction that a triangle which
  /// closes the hole would have them.
  std::vector<std::vector<int>> holes() const;
  /// Edges of more than two triangles.
  std::vector<std::pair<int, int>> crowded_edges() const;
  SurfaceSides sides() const;

 private:
  bool runs_along(int t, int from, int to) const;

  const TriangleSurface& surface_;
  std::map<std::pair<int, int>, std::vector<int>> edges_;
};

}  // namespace palpate::mesh
