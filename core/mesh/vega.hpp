#pragma once

#include <functional>
#include <istream>
#include <string>

#include "core/mesh/mesh_reader.hpp"

namespace palpate::mesh {

/// Opens the file named in an *INCLUDE line and returns its content; throws if that fails.
using Includer = std::function<std::string(const std::string& name)>;

/// Reads Vega's .veg: *VERTICES and *ELEMENTS (TETS), directly or by *INCLUDE, 0- or 1-based as
/// given by the first vertex. *SET of elements become groups; *MATERIAL, *REGION and other sections
/// are ignored. `name` is used in error messages. Throws ParseError.
MeshWithGroups read_vega(std::istream& stream, const std::string& name, const Includer& include,
                         OnFault on_fault = OnFault::kThrow);

}  // namespace palpate::mesh
