#pragma once

#include <ostream>
#include <string>

#include "core/mesh/element_mesh.hpp"
#include "core/mesh/mesh_reader.hpp"

namespace palpate::mesh {

// Numbers are written with the fewest digits that give the same double again, so that a mesh read
// back is the same to the bit. Streams must be open for binary output where that is asked for.

enum class GmshVersion { k2_2, k4_1 };
enum class Encoding { kText, kBinary };

struct GmshFormat {
  GmshVersion version = GmshVersion::k4_1;
  Encoding encoding = Encoding::kText;
  ElementOrder order = ElementOrder::kLinear;
};

/// Tetrahedra and groups as Gmsh's physical groups, numbers from 1. An element in several groups is
/// written in all of them by version 4.1; version 2.2 can name one, the first by name. Throws
/// std::invalid_argument for an index out of range.
void write_gmsh(const MeshWithGroups& mesh, const GmshFormat& format, std::ostream& out);

/// The pair of TetGen, linear, numbers from `first` (0 or 1).
void write_tetgen(const TetrahedralMesh& mesh, int first, std::ostream& node, std::ostream& ele);

/// Vega's .veg, linear, numbers from `first`: groups of tetrahedra become *SET, and everything is
/// of the material given (E in Pa, density in kg/m^3), which Vega cannot do without.
struct VegaMaterial {
  double young_modulus = 30e3;
  double poisson_ratio = 0.3;
  double density = 1000;
};
void write_vega(const MeshWithGroups& mesh, const VegaMaterial& material, int first,
                std::ostream& out);

/// The nodes that elements of an order need: straight-sided, but for the edges whose middles the
/// mesh knows.
ElementMesh element_mesh(const MeshWithGroups& mesh, ElementOrder order);

/// The shortest text that reads as the same double, whatever the locale.
std::string shortest(double value);

}  // namespace palpate::mesh
