#pragma once

#include <functional>
#include <istream>
#include <string>

#include "core/mesh/mesh_reader.hpp"

namespace palpate::mesh {

/// What an *INCLUDE line names, opened and read to its end; throws where it cannot be.
using Includer = std::function<std::string(const std::string& name)>;

/// Reads Vega's .veg: *VERTICES and *ELEMENTS (TETS), in place or by *INCLUDE, 0- or 1-based as the
/// first vertex says. *SET of elements become groups; *MATERIAL, *REGION and other sections are
/// passed over. `name` stands in errors. Throws ParseError.
MeshWithGroups read_vega(std::istream& stream, const std::string& name, const Includer& include,
                         OnFault on_fault = OnFault::kThrow);

}  // namespace palpate::mesh
