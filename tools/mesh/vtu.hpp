#pragma once

#include <istream>
#include <ostream>
#include <string>

#include "core/mesh/element_mesh.hpp"
#include "core/mesh/mesh_reader.hpp"
#include "tools/common/vtu_writer.hpp"

namespace palpate::mesh_tool {

/// Reads VTK's unstructured grid in XML (.vtu): tetrahedra of 4 and 10 nodes; other solids as
/// OnFault specifies; triangles, lines and points are ignored. Data as ASCII, base64 inline or
/// appended, or raw appended; zlib or none; little-endian. Integer cell data whose names begin with
/// "group:" become groups. Throws mesh::ParseError.
mesh::MeshWithGroups read_vtu(std::istream& stream, const std::string& name,
                              mesh::OnFault on_fault);

using common::VtuEncoding;

/// Writes the same, with the elements' radius ratio as cell data "quality", and one array of 0 and
/// 1 for each group of tetrahedra.
void write_vtu(const mesh::MeshWithGroups& mesh, mesh::ElementOrder order, VtuEncoding encoding,
               std::ostream& out);

}  // namespace palpate::mesh_tool
