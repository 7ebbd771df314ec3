#pragma once

#include <istream>
#include <ostream>
#include <string>

#include "core/mesh/mesh_reader.hpp"
#include "core/mesh/triangle_surface.hpp"

namespace palpate::mesh {

/// Reads STL, ASCII or binary. Corners that are the same to the bit become one point. A coordinate
/// that is not finite stays as it is, for a report. Throws ParseError.
TriangleSurface read_stl(std::istream& stream, const std::string& name);

/// Reads Wavefront's OBJ: v and f lines; faces of more corners are cut into fans, negative numbers
/// count from the last vertex. Others are passed over. A face that names a vertex which is not
/// there keeps -1. Throws ParseError.
TriangleSurface read_obj(std::istream& stream, const std::string& name);

/// ASCII STL, numbers with as many digits as they need.
void write_stl(const TriangleSurface& surface, std::ostream& out);
void write_obj(const TriangleSurface& surface, std::ostream& out);

}  // namespace palpate::mesh
