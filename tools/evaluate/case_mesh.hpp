#pragma once

#include <array>

#include "core/mesh/grid_mesh.hpp"
#include "core/mesh/mesh_reader.hpp"
#include "tools/evaluate/case_file.hpp"

namespace palpate::evaluate {

/// The Gmsh mesh of that name ("coarse" is mesh_coarse.msh). Throws config::Error where there is
/// none or it cannot be read.
mesh::MeshWithGroups read_case_mesh(const CaseFile& c, const std::string& name);

/// A mesh of our own over a union of boxes, with some `cells` along each axis (at least one between
/// two planes where a box of the case begins or ends), and the case's groups on its surface. Throws
/// config::Error for a body that is not made of boxes, or a region without a box.
mesh::MeshWithGroups make_case_mesh(const CaseFile& c, const std::array<int, 3>& cells,
                                    mesh::CellCut cut);

}  // namespace palpate::evaluate
