#pragma once

#include <Eigen/SparseCore>
#include <vector>

namespace palpate::baselines {

/// Cholesky factor L D L^T of a graph Laplacian without the rows and columns of prescribed nodes.
/// All axes of a nodal vector are solved together.
class LaplacianFactor {
 public:
  /// `laplacian`: n x n, symmetric, both triangles; `given`: prescribed nodes. Not usable if all
  /// nodes are prescribed, or none of a connected component. Allocates.
  LaplacianFactor(const Eigen::SparseMatrix<double>& laplacian, const std::vector<bool>& given);

  bool is_usable() const noexcept { return usable_; }
  // free nodes, in elimination order
  const std::vector<int>& nodes() const noexcept { return nodes_; }
  /// Overwrites the free nodes' columns of `b`, 3 x n, with the solution; other columns are
  /// unchanged. Requires is_usable().
  void solve(Eigen::Matrix3Xd& b) noexcept;

 private:
  bool usable_ = false;
  std::vector<int> nodes_;
  std::vector<int> start_, row_;
  std::vector<double> lower_, inverse_d_;
  Eigen::Matrix3Xd y_;
};

}  // namespace palpate::baselines
