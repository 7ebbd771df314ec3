#pragma once

#include <istream>
#include <string>

#include "core/mesh/gmsh_content.hpp"

namespace palpate::mesh {

/// Reads the part of a binary .msh after the format line, version 2 or 4(.1), little-endian. Throws
/// ParseError naming file and byte.
void read_gmsh_binary(std::istream& stream, const std::string& name, int version,
                      GmshContent& content);

/// Body of $PhysicalNames, which is text in both forms.
void read_gmsh_names(LineReader& reader, GmshContent& content);

}  // namespace palpate::mesh
