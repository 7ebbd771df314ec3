#pragma once

#include "core/mesh/repair.hpp"
#include "core/mesh/triangle_surface.hpp"

namespace palpate::mesh {

struct SurfaceRepairOptions {
  double merge_tolerance = 1e-7;  // points so near are one, by the diagonal of the surface's box
  int largest_hole = 32;          // edges round a hole that is closed; 0: none is
  Parts parts = Parts::kKeepAll;
};

/// Mends what can be mended, in this order: near points are merged (STL files store each corner
/// with its triangle, rounded); triangles without area and repeated ones are dropped, those that
/// only lie on an edge by turning that edge; small bodies are dropped where that is asked for, with
/// what lies in them; small holes are closed by triangles between the points of their rim, of the
/// least area; triangles are turned like their neighbours and the whole outside out; points in no
/// triangle are dropped. What check() still finds cannot be mended.
std::vector<RepairStep> repair(TriangleSurface& surface, const SurfaceRepairOptions& options);

/// Triangles (columns of points) that close a loop of points with the least area, turned along the
/// loop. Loops of less than three points have none.
Eigen::Matrix3Xi close_loop(const Eigen::Matrix3Xd& points, const std::vector<int>& loop);

}  // namespace palpate::mesh
