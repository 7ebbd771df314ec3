#pragma once

#include <istream>
#include <string>

#include "core/mesh/mesh_reader.hpp"

namespace palpate::mesh {

/// Reads Gmsh's .msh, versions 2.x and 4.1, ASCII or binary (little-endian): tetrahedra (10-node
/// ones as corners and middles of edges) and the physical groups of triangles and tetrahedra by
/// name (by number where they have no name). Node numbers may have gaps; nodes that no tetrahedron
/// uses are left out (Gmsh writes construction points; OnFault::kKeep keeps those in no element at
/// all). Lengths and orientation as in the file. `name` stands in errors. Throws ParseError.
MeshWithGroups read_gmsh(std::istream& stream, const std::string& name,
                         OnFault on_fault = OnFault::kThrow);

}  // namespace palpate::mesh
