#pragma once

#include <Eigen/Core>

namespace palpate::math {

/// Thin factorisation N = Q R of up to kMost columns of length at most kMost; columns are added and
/// removed one at a time by Gram-Schmidt with reorthogonalisation, which keeps Q orthogonal to
/// rounding (Daniel, Gragg, Kaufman and Stewart 1976). Never allocates.
class ColumnFactor {
 public:
  static constexpr int kMost = 16;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMost, 1>;
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMost, kMost>;

  /// Removes all columns; new ones have length `length`, 1 to kMost.
  void clear(int length) noexcept;
  int count() const noexcept { return count_; }

  /// column = Q inside + outside with Q^T outside = 0. outside is exactly zero if Q is square.
  void split(const Vector& column, Vector& inside, Vector& outside) const noexcept;

  /// Appends the column decomposed by split(); its part `outside` must not vanish.
  void append(const Vector& inside, const Vector& outside) noexcept;

  /// Removes column `index`; those after it move up.
  void remove(int index) noexcept;

  /// x <- R^-1 x and x <- R^-T x, length count().
  void solve(Vector& x) const noexcept;
  void solve_transposed(Vector& x) const noexcept;

  /// Q, length x count().
  auto basis() const noexcept { return Q_.leftCols(count_); }

 private:
  int length_ = 1;
  int count_ = 0;
  Matrix Q_ = Matrix::Zero(kMost, kMost);
  Matrix R_ = Matrix::Zero(kMost, kMost);
};

}  // namespace palpate::math
