#pragma once

#include <Eigen/StdVector>
#include <vector>

#include "core/elasticity/block_matrix.hpp"

namespace palpate::elasticity {

/// A = L D L^T by 3 x 3 blocks for positive definite matrices: the up-looking method of Davis (LDL,
/// 2005). Storage is fixed by the pattern, so that neither factorise nor solve allocates.
class BlockLdl {
 public:
  explicit BlockLdl(const BlockPattern& pattern);

  int size() const { return static_cast<int>(inverse_pivots_.size()); }
  std::size_t block_count() const { return row_.size(); }  // of L below its diagonal

  /// `held[i]` true: unknown i is kept at zero (its row and column become those of the identity).
  /// `shift` (N/m) is added to the diagonal. False where a pivot is not positive, to rounding: the
  /// matrix is indefinite or singular and the factor cannot be used.
  bool factorise(const BlockMatrix& A, const std::vector<char>& held, double shift) noexcept;

  /// Overwrites b with the solution; columns are unknowns in elimination order, row 3 is padding.
  void solve(Eigen::Matrix4Xd& b) const noexcept;

 private:
  // Three columns of four rows, the last of them zero, for full-width vector instructions.
  using Padded = Eigen::Matrix<double, 4, 3>;

  std::vector<std::vector<std::pair<int, int>>> upper_;  // (i, slot) of column k, i <= k
  std::vector<int> parent_;                              // elimination tree
  std::vector<int> column_start_;                        // of L, strictly below the diagonal
  std::vector<int> row_;
  std::vector<Padded> lower_;
  std::vector<Eigen::Matrix3d> inverse_pivots_;
  // Work space of factorise.
  std::vector<int> filled_, flag_, stack_;
  std::vector<Padded> y_;
};

}  // namespace palpate::elasticity
