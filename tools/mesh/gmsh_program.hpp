#pragma once

#include <functional>
#include <string>

#include "core/mesh/mesh_reader.hpp"
#include "core/mesh/triangle_surface.hpp"

namespace palpate::mesh_tool {

/// What becomes of the triangles of a surface that is filled.
enum class SurfaceTriangles {
  kRemesh,  // new ones of the wanted size, with the surface's edges kept
  kKeep,    // they are the boundary, as they are
};

struct MeshingOptions {
  double edge = 0.01;         // m, that edges should have
  double feature_angle = 40;  // degrees between triangles from which their edge is kept
  double time_limit = 600;    // s
  SurfaceTriangles triangles = SurfaceTriangles::kRemesh;
  std::string program = "gmsh";
};

/// Told the share of the work that is done, 0 to 1, and what is being done.
using MeshingProgress = std::function<void(double, const std::string&)>;

/// Fills a closed surface (cavities among it) with tetrahedra by the program gmsh, with its own
/// optimiser. Throws std::runtime_error: where the program is not installed, with the package's
/// name; where it fails, with the end of its messages; where time runs out.
mesh::MeshWithGroups fill_by_gmsh(const mesh::TriangleSurface& surface,
                                  const MeshingOptions& options, const MeshingProgress& progress);

}  // namespace palpate::mesh_tool
