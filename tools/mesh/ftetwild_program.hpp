#pragma once

#include <string>

#include "core/mesh/mesh_reader.hpp"
#include "core/mesh/triangle_surface.hpp"

namespace palpate::mesh_tool {

struct FtetwildOptions {
  double edge = 0.01;       // m, target edge length
  double envelope = 1e-3;   // largest deviation from the triangles, by the surface's diagonal
  double time_limit = 600;  // s
  std::string program = "FloatTetwild_bin";
};

/// Fills the inside of triangles with holes, overlaps and self-intersections by fTetWild (Hu,
/// Schneider, Wang, Zorin and Panozzo 2020), which runs as a program. What is inside follows from
/// the winding number, so most triangles must look outward. Throws std::runtime_error: with where
/// the program comes from if it is not installed; with the end of its messages if it fails or makes
/// no tetrahedra; or on time-out.
mesh::MeshWithGroups fill_by_ftetwild(const mesh::TriangleSurface& surface,
                                      const FtetwildOptions& options);

}  // namespace palpate::mesh_tool
