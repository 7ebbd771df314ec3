#pragma once

#include <functional>
#include <vector>

#include "core/mesh/tetrahedral_mesh.hpp"

namespace palpate::mesh {

/// Decomposition of a grid cell into tetrahedra; faces of neighbours match in each case.
enum class CellCut {
  kSix,   // Kuhn: identical cells, with a diagonal through the cell
  kFive,  // one in the centre and four at corners, mirrored from cell to cell; fewest edges
};

/// Grid planes along each axis, m, strictly ascending, at least two.
using GridPlanes = std::array<std::vector<double>, 3>;

/// `cells` of equal length along each axis, from `lower` over `size`, m.
GridPlanes even_planes(const Eigen::Vector3d& lower, const Eigen::Vector3d& size,
                       const std::array<int, 3>& cells);

/// Moves inner planes of one axis, m, so that the coordinates `through`, m, are planes, and spaces
/// the others evenly between them. Coordinates on or beyond the ends are ignored, as are those for
/// which no inner plane is left.
void align(const std::vector<double>& through, std::vector<double>& planes);

/// Tetrahedra of those grid cells whose centre `keep` accepts (all if it is empty); nodes and cells
/// are ordered with x running fastest. Throws std::invalid_argument for invalid planes or if no
/// cell remains.
TetrahedralMesh make_grid(const GridPlanes& planes, CellCut cut,
                          const std::function<bool(const Eigen::Vector3d&)>& keep = {});

}  // namespace palpate::mesh
