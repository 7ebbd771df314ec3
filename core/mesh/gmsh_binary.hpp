#pragma once

#include <istream>
#include <string>

#include "core/mesh/gmsh_content.hpp"

namespace palpate::mesh {

/// Reads what follows the format line of a binary .msh, version 2 or 4(.1), little-endian. Throws
/// ParseError that names file and byte.
void read_gmsh_binary(std::istream& stream, const std::string& name, int version,
                      GmshContent& content);

/// The body of $PhysicalNames, which is text in either form.
void read_gmsh_names(LineReader& reader, GmshContent& content);

}  // namespace palpate::mesh
