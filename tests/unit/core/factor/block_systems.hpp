#pragma once

#include <Eigen/Cholesky>

#include "core/elasticity/element_set.hpp"
#include "core/factor/block_matrix.hpp"
#include "tests/unit/core/elasticity/bodies.hpp"

namespace palpate::factor {

inline constexpr std::array<Held, 4> kHeldSets{
    {{false, false}, {true, false}, {false, true}, {true, true}}};

/// A block matrix with the sparsity pattern of a mesh, and its dense equivalent.
struct BlockSystem {
  BlockSystem(const mesh::ElementMesh& mesh, const std::vector<int>& fixed,
              const std::vector<std::vector<int>>& border)
      : elements(mesh.elements),
        pattern(mesh.elements, mesh.node_count(), fixed, border),
        dense(Eigen::MatrixXd::Zero(3 * pattern.size(), 3 * pattern.size())) {}
  BlockSystem(const BlockSystem&) = delete;

  void add(int element, const Eigen::MatrixXd& K) {
    matrix.add(element, K);
    const Eigen::VectorXi nodes = elements.col(element);
    for (int a = 0; a < nodes.size(); ++a) {
      for (int b = 0; b < nodes.size(); ++b) {
        const int i = pattern.unknown(nodes(a)), k = pattern.unknown(nodes(b));
        if (i >= 0 && k >= 0) dense.block<3, 3>(3 * i, 3 * k) += K.block<3, 3>(3 * a, 3 * b);
      }
    }
  }

  void add_stiffness(const elasticity::ElementSet& set, const Eigen::Matrix3Xd& x) {
    Eigen::MatrixXd K;
    for (int e = 0; e < set.element_count(); ++e) {
      set.stiffness(e, x, elasticity::Tangent::kExact, 0, K);
      add(e, K);
    }
  }

  /// Positive definite element matrices drawn at random.
  void add_random() {
    const int n = 3 * static_cast<int>(elements.rows());
    for (int e = 0; e < elements.cols(); ++e) {
      const Eigen::MatrixXd G = Eigen::MatrixXd::Random(n, n);
      add(e, G * G.transpose());
    }
  }

  /// Scalar rows that are free.
  std::vector<int> free_rows(Held held) const {
    std::vector<int> rows;
    for (int k = 0; k < 3 * pattern.size(); ++k) {
      if (pattern.is_free(k / 3, held)) rows.push_back(k);
    }
    return rows;
  }

  Eigen::MatrixXd free_part(Held held) const {
    const std::vector<int> rows = free_rows(held);
    return dense(rows, rows);
  }

  /// Solution with the constrained rows at zero.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& B, Held held) const {
    const std::vector<int> rows = free_rows(held);
    Eigen::MatrixXd X = Eigen::MatrixXd::Zero(B.rows(), B.cols());
    if (rows.empty()) return X;
    X(rows, Eigen::all) =
        Eigen::MatrixXd(free_part(held).ldlt().solve(Eigen::MatrixXd(B(rows, Eigen::all))));
    return X;
  }

  Eigen::MatrixXi elements;
  BlockPattern pattern;
  BlockMatrix matrix{pattern};
  Eigen::MatrixXd dense;
};

/// A bar with both of its ends free to be grasped, fixed, if at all, in the middle of its length.
struct TwoHandedBar {
  explicit TwoHandedBar(mesh::ElementOrder order, std::array<int, 3> cells = {6, 2, 2})
      : body(elasticity::make_bar({0.2, 0.05, 0.05}, cells, order)),
        ends{elasticity::nodes_at(body.mesh, 0, 0), elasticity::nodes_at(body.mesh, 0, 0.2)},
        middle(elasticity::nodes_at(body.mesh, 0, 0.1)),
        set(body) {}

  elasticity::Body body;
  std::vector<std::vector<int>> ends;
  std::vector<int> middle;
  elasticity::ElementSet set;
};

}  // namespace palpate::factor
