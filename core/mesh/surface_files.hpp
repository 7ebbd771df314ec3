#pragma once

#include <istream>
#include <ostream>
#include <string>

#include "core/mesh/mesh_reader.hpp"
#include "core/mesh/triangle_surface.hpp"

namespace palpate::mesh {

/// Reads STL, ASCII or binary. Bitwise equal corners become one point. Non-finite coordinates are
/// kept for the report. Throws ParseError.
TriangleSurface read_stl(std::istream& stream, const std::string& name);

/// Reads Wavefront OBJ: v and f lines; polygons are divided into fans, negative numbers count from
/// the last vertex. Other lines are ignored. A reference to a missing vertex becomes -1. Throws
/// ParseError.
TriangleSurface read_obj(std::istream& stream, const std::string& name);

/// ASCII STL with the fewest digits that reproduce each number.
void write_stl(const TriangleSurface& surface, std::ostream& out);
void write_obj(const TriangleSurface& surface, std::ostream& out);

}  // namespace palpate::mesh
