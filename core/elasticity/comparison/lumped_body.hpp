#pragma once

#include <array>
#include <vector>

#include "core/elasticity/body.hpp"

namespace palpate::elasticity {

/// One tetrahedron with straight edges between nodes of a mesh.
struct LinearPiece {
  std::array<int, 4> nodes;
  int element;    // of the mesh, whose material it has
  double volume;  // m^3
};

/// A mesh as linear tetrahedra over all of its nodes: the elements of a linear mesh; eight for each
/// quadratic element, four at its corners and four round the shortest diagonal of the octahedron
/// between its midside nodes. Throws std::invalid_argument where a piece has no positive volume.
std::vector<LinearPiece> linear_pieces(const mesh::ElementMesh& mesh);

/// A quarter of the mass of each piece to each of its nodes, kg. Throws std::invalid_argument where
/// a node belongs to no element.
Eigen::VectorXd lumped_masses(const Body& body, const std::vector<LinearPiece>& pieces);

}  // namespace palpate::elasticity
