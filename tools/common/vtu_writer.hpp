#pragma once

#include <Eigen/Core>
#include <ostream>
#include <string>
#include <vector>

namespace palpate::common {

/// Kinds of cells, by VTK's numbers.
enum class CellKind {
  kVertex = 1,
  kTetrahedron = 10,
  kQuadraticTetrahedron = 24,
  kHexahedron27 = 29,
};

/// A field of a grid: one column per point or cell.
struct GridField {
  std::string name;
  Eigen::MatrixXd values;
  bool is_flag = false;  // only 0 and 1, stored as bytes
};

/// An unstructured grid of one kind of cells.
struct Grid {
  Eigen::Matrix3Xd points;
  CellKind kind = CellKind::kVertex;
  Eigen::MatrixXi cells;  // nodes per cell x cells, in VTK's order
  std::vector<GridField> point_fields, cell_fields;
};

enum class VtuEncoding { kAscii, kBase64 };

/// Writes a VTK XML file (.vtu): little-endian, positions and fields as 64-bit floats, which either
/// encoding preserves bit-exactly. Throws std::invalid_argument if a field has the wrong length.
void write_vtu(const Grid& grid, VtuEncoding encoding, std::ostream& out);

}  // namespace palpate::common
