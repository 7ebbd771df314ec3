#pragma once

#include <functional>
#include <istream>
#include <string>

#include "core/mesh/mesh_reader.hpp"

namespace palpate::mesh {

/// Reads TetGen's .node and .ele ('#' comments; 0- or 1-based as given by the first node;
/// attributes and boundary markers are ignored; 10-node elements are reduced to their corners).
/// Lengths and orientation as in the file. The names are used in error messages. Throws ParseError.
MeshWithGroups read_tetgen(std::istream& node, const std::string& node_name, std::istream& ele,
                           const std::string& ele_name, OnFault on_fault = OnFault::kThrow);

/// Body of a .node or .ele after its header line, also within files that contain both (Vega's
/// .veg): the present line of `reader` is the header. `first` becomes the index of the first node.
Eigen::Matrix3Xd read_tetgen_nodes(LineReader& reader, long& first,
                                   OnFault on_fault = OnFault::kThrow);
Eigen::Matrix4Xi read_tetgen_elements(LineReader& reader, long first, int node_count,
                                      OnFault on_fault = OnFault::kThrow);

/// Opens the file named in an *INCLUDE line and returns its content; throws if that fails.
using Includer = std::function<std::string(const std::string& name)>;

/// Reads Vega's .veg: *VERTICES and *ELEMENTS (TETS), directly or by *INCLUDE, 0- or 1-based as
/// given by the first vertex. *SET of elements become groups; *MATERIAL, *REGION and other sections
/// are ignored. `name` is used in error messages. Throws ParseError.
MeshWithGroups read_vega(std::istream& stream, const std::string& name, const Includer& include,
                         OnFault on_fault = OnFault::kThrow);

/// Reads Gmsh's .msh, versions 2.x and 4.1, ASCII or binary (little-endian): tetrahedra (10-node
/// ones as corners and edge midpoints) and the physical groups of triangles and tetrahedra by name
/// (by number if unnamed). Node numbers may have gaps; nodes without a tetrahedron are omitted
/// (Gmsh writes construction points; OnFault::kKeep keeps nodes in no element at all). Lengths and
/// orientation as in the file. `name` is used in error messages. Throws ParseError.
MeshWithGroups read_gmsh(std::istream& stream, const std::string& name,
                         OnFault on_fault = OnFault::kThrow);

}  // namespace palpate::mesh
