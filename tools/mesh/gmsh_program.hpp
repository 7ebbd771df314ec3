#pragma once

#include <functional>
#include <string>

#include "core/mesh/mesh_reader.hpp"
#include "core/mesh/triangle_surface.hpp"

namespace palpate::mesh_tool {

/// Treatment of the triangles of a surface that is filled.
enum class SurfaceTriangles {
  kRemesh,  // new ones of the requested size, with the surface's edges preserved
  kKeep,    // they remain the boundary unchanged
};

struct MeshingOptions {
  double edge = 0.01;         // m, target edge length
  double feature_angle = 40;  // degrees between triangles above which their edge is preserved
  double time_limit = 600;    // s
  SurfaceTriangles triangles = SurfaceTriangles::kRemesh;
  std::string program = "gmsh";
};

/// Called with the completed fraction, 0 to 1, and a description of the current stage.
using MeshingProgress = std::function<void(double, const std::string&)>;

/// Fills a closed surface (including cavities) with tetrahedra by the program gmsh, with its own
/// optimiser. Throws std::runtime_error: with the package's name if the program is not installed;
/// with the end of its messages if it fails; or on time-out.
mesh::MeshWithGroups fill_by_gmsh(const mesh::TriangleSurface& surface,
                                  const MeshingOptions& options, const MeshingProgress& progress);

/// Finds the positions of the midpoints of a mesh's boundary edges on the surface it was made of,
/// and stores those that lie off the straight edge, so that quadratic elements follow the surface
/// and straight ones can be given its volume (mesh::keep_curved_volume). Returns their number.
int follow_surface(const mesh::TriangleSurface& surface, mesh::MeshWithGroups& mesh);

}  // namespace palpate::mesh_tool
