#pragma once

#include <array>
#include <vector>

#include "core/elasticity/body.hpp"

namespace palpate::elasticity {

/// Straight-edged tetrahedron between nodes of a mesh.
struct LinearPiece {
  std::array<int, 4> nodes;
  int element;    // element of the mesh that it belongs to and whose material it has
  double volume;  // m^3
};

/// Decomposes a mesh into linear tetrahedra over all of its nodes: the elements of a linear mesh;
/// eight per quadratic element, four at its corners and four around the shortest diagonal of the
/// octahedron between its midside nodes. Throws std::invalid_argument if a piece has no positive
/// volume.
std::vector<LinearPiece> linear_pieces(const mesh::ElementMesh& mesh);

/// Lumped masses: a quarter of each piece's mass per node, kg. Throws std::invalid_argument if a
/// node belongs to no element.
Eigen::VectorXd lumped_masses(const Body& body, const std::vector<LinearPiece>& pieces);

}  // namespace palpate::elasticity
