#pragma once

#include <istream>
#include <string>

#include "core/mesh/mesh_reader.hpp"

namespace palpate::mesh {

/// Reads TetGen's .node and .ele ('#' comments; 0- or 1-based, as the first node says; attributes
/// and boundary markers are passed over; of 10-node elements the corners are taken). Lengths and
/// orientation as in the file. The names stand in errors. Throws ParseError.
TetrahedralMesh read_tetgen(std::istream& node, const std::string& node_name, std::istream& ele,
                            const std::string& ele_name, OnFault on_fault = OnFault::kThrow);

/// The body of a .node or .ele after its header line, in files that hold both (Vega's .veg): reads
/// what `reader` stands on as the header. `first` becomes the index of the first node.
Eigen::Matrix3Xd read_tetgen_nodes(LineReader& reader, long& first,
                                   OnFault on_fault = OnFault::kThrow);
Eigen::Matrix4Xi read_tetgen_elements(LineReader& reader, long first, int node_count,
                                      OnFault on_fault = OnFault::kThrow);

}  // namespace palpate::mesh
