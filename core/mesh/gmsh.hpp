#pragma once

#include <istream>
#include <string>

#include "core/mesh/mesh_reader.hpp"

namespace palpate::mesh {

/// Reads Gmsh's .msh, versions 2.x and 4.1, ASCII or binary (little-endian): tetrahedra (10-node
/// ones as corners and edge midpoints) and the physical groups of triangles and tetrahedra by name
/// (by number if unnamed). Node numbers may have gaps; nodes without a tetrahedron are omitted
/// (Gmsh writes construction points; OnFault::kKeep keeps nodes in no element at all). Lengths and
/// orientation as in the file. `name` is used in error messages. Throws ParseError.
MeshWithGroups read_gmsh(std::istream& stream, const std::string& name,
                         OnFault on_fault = OnFault::kThrow);

}  // namespace palpate::mesh
