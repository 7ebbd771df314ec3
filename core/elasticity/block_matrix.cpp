#include "core/elasticity/block_matrix.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>

namespace palpate::elasticity {

BlockPattern::BlockPattern(const Eigen::MatrixXi& elements, int node_count,
                           const std::vector<int>& fixed)
    : nodes_per_element_(static_cast<int>(elements.rows())), unknown_(node_count, 0) {
  for (int node : fixed) unknown_[node] = -1;
  std::vector<int> natural;
  for (int node = 0; node < node_count; ++node) {
    if (unknown_[node] < 0) continue;
    unknown_[node] = static_cast<int>(natural.size());
    natural.push_back(node);
  }
  const int n = static_cast<int>(natural.size());

  std::vector<Eigen::Triplet<double>> entries;
  for (int e = 0; e < elements.cols(); ++e) {
    for (int a : elements.col(e)) {
      for (int b : elements.col(e)) {
        if (unknown_[a] >= 0 && unknown_[b] >= 0) entries.emplace_back(unknown_[a], unknown_[b], 1);
      }
    }
  }
  for (int i = 0; i < n; ++i) entries.emplace_back(i, i, 1);
  Eigen::SparseMatrix<double> graph(n, n);
  graph.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation(n);
  if (n > 0) Eigen::AMDOrdering<int>()(graph, permutation);

  node_.resize(n);
  for (int i = 0; i < n; ++i) node_[i] = natural[permutation.indices()(i)];
  for (int i = 0; i < n; ++i) unknown_[node_[i]] = i;

  column_start_.assign(n + 1, 0);
  for (int k = 0; k < n; ++k) {
    const int column = permutation.indices()(k);
    const std::size_t begin = row_.size();
    for (Eigen::SparseMatrix<double>::InnerIterator it(graph, column); it; ++it) {
      const int i = unknown_[natural[it.row()]];
      if (i <= k) row_.push_back(i);
    }
    std::sort(row_.begin() + static_cast<std::ptrdiff_t>(begin), row_.end());
    column_start_[k + 1] = static_cast<int>(row_.size());
  }

  slots_.assign(elements.size() * nodes_per_element_, -1);
  for (int e = 0; e < elements.cols(); ++e) {
    for (int a = 0; a < nodes_per_element_; ++a) {
      for (int b = 0; b < nodes_per_element_; ++b) {
        const int i = unknown_[elements(a, e)], k = unknown_[elements(b, e)];
        if (i < 0 || k < 0 || i > k) continue;
        const auto found = std::lower_bound(row_.begin() + column_start_[k],
                                            row_.begin() + column_start_[k + 1], i);
        slots_[(e * nodes_per_element_ + a) * nodes_per_element_ + b] =
            static_cast<int>(found - row_.begin());
      }
    }
  }
}

BlockMatrix::BlockMatrix(const BlockPattern& pattern)
    : pattern_(&pattern), blocks_(pattern.row().size(), Eigen::Matrix3d::Zero()) {}

void BlockMatrix::set_zero() { std::fill(blocks_.begin(), blocks_.end(), Eigen::Matrix3d::Zero()); }

void BlockMatrix::add(int element, const Eigen::MatrixXd& K) {
  const int n = static_cast<int>(K.rows()) / 3;
  for (int a = 0; a < n; ++a) {
    for (int b = 0; b < n; ++b) {
      const int slot = pattern_->slot(element, a, b);
      if (slot >= 0) blocks_[slot] += K.block<3, 3>(3 * a, 3 * b);
    }
  }
}

void BlockMatrix::add_scalar(int element, double factor, const Eigen::MatrixXd& M) {
  const int n = static_cast<int>(M.rows());
  for (int a = 0; a < n; ++a) {
    for (int b = 0; b < n; ++b) {
      const int slot = pattern_->slot(element, a, b);
      if (slot >= 0) blocks_[slot].diagonal().array() += factor * M(a, b);
    }
  }
}

void BlockMatrix::multiply(const Eigen::Matrix3Xd& u, Eigen::Matrix3Xd& y) const {
  y.setZero();
  const std::vector<int>& start = pattern_->column_start();
  for (int k = 0; k < pattern_->size(); ++k) {
    const int node_k = pattern_->node(k);
    for (int s = start[k]; s < start[k + 1]; ++s) {
      const int node_i = pattern_->node(pattern_->row()[s]);
      y.col(node_i).noalias() += blocks_[s] * u.col(node_k);
      if (node_i != node_k) y.col(node_k).noalias() += blocks_[s].transpose() * u.col(node_i);
    }
  }
}

}  // namespace palpate::elasticity
