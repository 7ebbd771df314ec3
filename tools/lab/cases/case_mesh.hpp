#pragma once

#include <array>

#include "core/mesh/grid_mesh.hpp"
#include "core/mesh/mesh_reader.hpp"
#include "tools/lab/cases/case_file.hpp"

namespace palpate::cases {

/// The Gmsh mesh of that name ("coarse" is mesh_coarse.msh). Throws config::Error if there is none
/// or it cannot be read.
mesh::MeshWithGroups read_case_mesh(const CaseFile& c, const std::string& name);

/// Parameters for meshing a union of boxes.
struct CaseGrid {
  std::array<int, 3> cells{1, 1, 1};  // along each axis; at least one between two planes where a
                                      // box of the case begins or ends
  mesh::CellCut cut = mesh::CellCut::kFive;
  double grading =
      1;  // distances from the clamp are raised to this power: above 1 cells are narrow there

  std::string text() const;  // such as "9x2x2" or "9x2x2^1.5"
};

/// A generated mesh, with the case's groups on its surface. Throws config::Error for a body that is
/// not made of boxes, or a region without a box.
mesh::MeshWithGroups make_case_mesh(const CaseFile& c, const CaseGrid& grid);

}  // namespace palpate::cases
