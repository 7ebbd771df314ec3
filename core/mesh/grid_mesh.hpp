#pragma once

#include <functional>
#include <vector>

#include "core/mesh/tetrahedral_mesh.hpp"

namespace palpate::mesh {

/// How a cell of a grid becomes tetrahedra; faces of neighbours match in each.
enum class CellCut {
  kSix,   // Kuhn: all cells alike, with a diagonal through the cell
  kFive,  // one inside and four at corners, mirrored from cell to cell; needs the fewest edges
};

/// Planes of a grid along each axis, m, strictly rising, at least two.
using GridPlanes = std::array<std::vector<double>, 3>;

/// Tetrahedra of those cells of a grid whose centre `keep` accepts (all where it is empty), nodes
/// and cells ordered with x running fastest. Throws std::invalid_argument for bad planes, or where
/// no cell is left.
TetrahedralMesh make_grid(const GridPlanes& planes, CellCut cut,
                          const std::function<bool(const Eigen::Vector3d&)>& keep = {});

}  // namespace palpate::mesh
