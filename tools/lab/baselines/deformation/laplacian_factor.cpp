#include "tools/lab/baselines/deformation/laplacian_factor.hpp"

#include <Eigen/SparseCholesky>

namespace palpate::baselines {

LaplacianFactor::LaplacianFactor(const Eigen::SparseMatrix<double>& laplacian,
                                 const std::vector<bool>& given) {
  std::vector<int> free_nodes, index(given.size(), -1);
  for (int node = 0; node < static_cast<int>(given.size()); ++node) {
    if (given[node]) continue;
    index[node] = static_cast<int>(free_nodes.size());
    free_nodes.push_back(node);
  }
  const auto n = static_cast<int>(free_nodes.size());
  if (n == 0 || n == static_cast<int>(given.size())) return;
  std::vector<Eigen::Triplet<double>> entries;
  for (int k = 0; k < laplacian.outerSize(); ++k) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(laplacian, k); it; ++it) {
      if (index[it.row()] >= 0 && index[it.col()] >= 0)
        entries.emplace_back(index[it.row()], index[it.col()], it.value());
    }
  }
  Eigen::SparseMatrix<double> A(n, n);
  A.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(A);
  if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 0)) return;

  nodes_.resize(n);
  for (int i = 0; i < n; ++i) nodes_[factor.permutationP().indices()[i]] = free_nodes[i];
  const Eigen::SparseMatrix<double>& L = factor.matrixL().nestedExpression();
  for (int j = 0; j < n; ++j) {
    start_.push_back(static_cast<int>(row_.size()));
    for (Eigen::SparseMatrix<double>::InnerIterator it(L, j); it; ++it) {
      if (it.row() <= j) continue;
      row_.push_back(static_cast<int>(it.row()));
      lower_.push_back(it.value());
    }
    inverse_d_.push_back(1 / factor.vectorD()[j]);
  }
  start_.push_back(static_cast<int>(row_.size()));
  y_.resize(3, n);
  usable_ = true;
}

void LaplacianFactor::solve(Eigen::Matrix3Xd& b) noexcept {
  const auto n = static_cast<int>(nodes_.size());
  for (int j = 0; j < n; ++j) y_.col(j) = b.col(nodes_[j]);
  for (int j = 0; j < n; ++j) {
    const Eigen::Vector3d value = y_.col(j);
    for (int k = start_[j]; k < start_[j + 1]; ++k) y_.col(row_[k]) -= lower_[k] * value;
  }
  for (int j = n - 1; j >= 0; --j) {
    Eigen::Vector3d value = inverse_d_[j] * y_.col(j);
    for (int k = start_[j]; k < start_[j + 1]; ++k) value -= lower_[k] * y_.col(row_[k]);
    y_.col(j) = value;
    b.col(nodes_[j]) = value;
  }
}

}  // namespace palpate::baselines
