#pragma once

#include <ostream>
#include <string>

#include "core/mesh/element_mesh.hpp"
#include "core/mesh/mesh_reader.hpp"

namespace palpate::mesh {

// Numbers are written with the fewest digits that reproduce the same double, so that a mesh is read
// back bit for bit. Streams must be open in binary mode for binary output.

enum class GmshVersion { k2_2, k4_1 };
enum class Encoding { kText, kBinary };

struct GmshFormat {
  GmshVersion version = GmshVersion::k4_1;
  Encoding encoding = Encoding::kText;
  ElementOrder order = ElementOrder::kLinear;
};

/// Tetrahedra and groups as Gmsh's physical groups, numbers from 1. Version 4.1 writes an element
/// of several groups in all of them; version 2.2 permits one, the first by name. Throws
/// std::invalid_argument for an index out of range.
void write_gmsh(const MeshWithGroups& mesh, const GmshFormat& format, std::ostream& out);

/// TetGen's pair of files, linear elements, numbers from `first` (0 or 1).
void write_tetgen(const TetrahedralMesh& mesh, int first, std::ostream& node, std::ostream& ele);

/// Vega's .veg, linear elements, numbers from `first`: groups of tetrahedra become *SET; all
/// elements get the given material (E in Pa, density in kg/m^3), which the format requires.
struct VegaMaterial {
  double young_modulus = 30e3;
  double poisson_ratio = 0.3;
  double density = 1000;
};
void write_vega(const MeshWithGroups& mesh, const VegaMaterial& material, int first,
                std::ostream& out);

/// Nodes required by elements of an order: straight-sided, except for edges whose midpoints the
/// mesh contains.
ElementMesh element_mesh(const MeshWithGroups& mesh, ElementOrder order);

/// Shortest text that reads as the same double, independent of the locale.
std::string shortest(double value);

}  // namespace palpate::mesh
