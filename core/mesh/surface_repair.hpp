#pragma once

#include "core/mesh/repair.hpp"
#include "core/mesh/triangle_surface.hpp"

namespace palpate::mesh {

struct SurfaceRepairOptions {
  /// Points within this distance, relative to the surface's bounding box diagonal, are merged.
  double merge_tolerance = 1e-7;
  int largest_hole = 32;  // largest number of edges of a hole that is closed; 0: none
  Parts parts = Parts::kKeepAll;
};

/// Repairs a surface, in this order: near points are merged (STL files store each corner with its
/// triangle, rounded); triangles without area and repeated ones are dropped, those whose corner
/// lies on an edge by flipping that edge; small bodies and their cavities are dropped on request;
/// small holes are closed by triangles of minimum area between the points of their rim; triangles
/// are oriented consistently and the whole surface outward; points in no triangle are dropped.
/// Faults that check() still reports cannot be repaired.
std::vector<RepairStep> repair(TriangleSurface& surface, const SurfaceRepairOptions& options);

/// Triangles (columns of points) that close a loop of points with minimum area, oriented along the
/// loop. None for loops of less than three points.
Eigen::Matrix3Xi close_loop(const Eigen::Matrix3Xd& points, const std::vector<int>& loop);

}  // namespace palpate::mesh
