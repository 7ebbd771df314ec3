#pragma once

#include <istream>
#include <string>

#include "core/mesh/mesh_reader.hpp"

namespace palpate::mesh {

/// Reads TetGen's .node and .ele ('#' comments; 0- or 1-based as given by the first node;
/// attributes and boundary markers are ignored; 10-node elements are reduced to their corners).
/// Lengths and orientation as in the file. The names are used in error messages. Throws ParseError.
TetrahedralMesh read_tetgen(std::istream& node, const std::string& node_name, std::istream& ele,
                            const std::string& ele_name, OnFault on_fault = OnFault::kThrow);

/// Body of a .node or .ele after its header line, also within files that contain both (Vega's
/// .veg): the present line of `reader` is the header. `first` becomes the index of the first node.
Eigen::Matrix3Xd read_tetgen_nodes(LineReader& reader, long& first,
                                   OnFault on_fault = OnFault::kThrow);
Eigen::Matrix4Xi read_tetgen_elements(LineReader& reader, long first, int node_count,
                                      OnFault on_fault = OnFault::kThrow);

}  // namespace palpate::mesh
