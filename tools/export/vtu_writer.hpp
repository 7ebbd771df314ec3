#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace palpate::exporting {

/// Kinds of cells, by VTK's numbers.
enum class CellKind { kVertex = 1, kTriangle = 5, kTetrahedron = 10, kHexahedron27 = 29 };

/// A field of a grid: one column per point or cell.
struct GridField {
  std::string name;
  Eigen::MatrixXd values;
};

/// An unstructured grid of one kind of cells.
struct Grid {
  Eigen::Matrix3Xd points;
  CellKind kind = CellKind::kVertex;
  Eigen::MatrixXi cells;  // nodes per cell x cells, in VTK's order
  std::vector<GridField> point_fields, cell_fields;
};

/// Writes a VTK XML file (.vtu): binary in base64, little-endian, positions and fields as 64-bit
/// floats. Throws std::runtime_error, and std::invalid_argument if a field has the wrong length.
void write_vtu(const std::filesystem::path& file, const Grid& grid);

/// An entry of a series.
struct SeriesEntry {
  double time = 0;  // s
  std::filesystem::path file;
};

/// Writes a .pvd file, which ParaView opens as one series over time. The files are named relative
/// to it.
void write_pvd(const std::filesystem::path& file, const std::vector<SeriesEntry>& entries);

}  // namespace palpate::exporting
