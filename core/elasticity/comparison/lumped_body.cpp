#include "core/elasticity/comparison/lumped_body.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/elasticity/element.hpp"

namespace palpate::elasticity {
namespace {

using Tetrahedra = std::array<std::array<int, 4>, 8>;

/// Pieces of a quadratic element in its local numbering.
Tetrahedra split(const std::array<int, 2>& diagonal, const std::array<int, 4>& ring) {
  Tetrahedra all = {{{0, 4, 6, 7}, {4, 1, 5, 8}, {6, 5, 2, 9}, {7, 8, 9, 3}}};
  for (int k = 0; k < 4; ++k) all[4 + k] = {diagonal[0], diagonal[1], ring[k], ring[(k + 1) % 4]};
  return all;
}

Tetrahedra split_at_shortest_diagonal(const Eigen::Matrix<double, 3, 10>& x) {
  // Opposite midside nodes, each with the other four in order around it.
  constexpr std::array<std::array<int, 2>, 3> kDiagonals = {{{4, 9}, {5, 7}, {6, 8}}};
  constexpr std::array<std::array<int, 4>, 3> kRings = {{{6, 5, 8, 7}, {4, 6, 9, 8}, {4, 5, 9, 7}}};
  int shortest = 0;
  double length = -1;
  for (int d = 0; d < 3; ++d) {
    const double l = (x.col(kDiagonals[d][0]) - x.col(kDiagonals[d][1])).norm();
    // equal lengths must not be distinguished by rounding errors
    if (length < 0 || l < length * (1 - 1e-9)) {
      length = l;
      shortest = d;
    }
  }
  return split(kDiagonals[shortest], kRings[shortest]);
}

void add_piece(const mesh::ElementMesh& mesh, int element, std::array<int, 4> local, bool may_turn,
               std::vector<LinearPiece>& pieces) {
  LinearPiece piece;
  piece.element = element;
  Eigen::Matrix<double, 3, 4> corners;
  for (int k = 0; k < 4; ++k) {
    piece.nodes[k] = mesh.elements(local[k], element);
    corners.col(k) = mesh.nodes.col(piece.nodes[k]);
  }
  piece.volume = tetrahedron_volume(corners);
  if (may_turn && piece.volume < 0) {
    std::swap(piece.nodes[2], piece.nodes[3]);
    piece.volume = -piece.volume;
  }
  if (!(piece.volume > 0)) {
    throw std::invalid_argument("element " + std::to_string(element) + " has no positive volume");
  }
  pieces.push_back(piece);
}

}  // namespace

std::vector<LinearPiece> linear_pieces(const mesh::ElementMesh& mesh) {
  std::vector<LinearPiece> pieces;
  for (int e = 0; e < mesh.element_count(); ++e) {
    if (mesh.order == mesh::ElementOrder::kLinear) {
      add_piece(mesh, e, {0, 1, 2, 3}, false, pieces);
      continue;
    }
    Eigen::Matrix<double, 3, 10> x;
    for (int a = 0; a < 10; ++a) x.col(a) = mesh.nodes.col(mesh.elements(a, e));
    const Tetrahedra tetrahedra = split_at_shortest_diagonal(x);
    // rings have either orientation
    for (int k = 0; k < 8; ++k) add_piece(mesh, e, tetrahedra[k], k >= 4, pieces);
  }
  return pieces;
}

Eigen::VectorXd lumped_masses(const Body& body, const std::vector<LinearPiece>& pieces) {
  Eigen::VectorXd masses = Eigen::VectorXd::Zero(body.mesh.node_count());
  for (const LinearPiece& piece : pieces) {
    const double share = body.material_of(piece.element).density * piece.volume / 4;
    for (int node : piece.nodes) masses(node) += share;
  }
  for (int i = 0; i < masses.size(); ++i) {
    if (!(masses(i) > 0)) {
      throw std::invalid_argument("node " + std::to_string(i) + " belongs to no element");
    }
  }
  return masses;
}

}  // namespace palpate::elasticity
