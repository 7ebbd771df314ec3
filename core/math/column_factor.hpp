#pragma once

#include <Eigen/Core>

namespace palpate::math {

/// Thin factors N = Q R of up to kMost columns of length at most kMost, of which one is added or
/// taken away at a time: Gram-Schmidt with a second pass, which keeps Q orthogonal to rounding
/// (Daniel, Gragg, Kaufman and Stewart 1976). Never allocates.
class ColumnFactor {
 public:
  static constexpr int kMost = 16;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMost, 1>;
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMost, kMost>;

  /// Takes all columns away; those to come are `length` long, 1 to kMost.
  void clear(int length) noexcept;
  int count() const noexcept { return count_; }

  /// column = Q inside + outside with Q^T outside = 0. Exactly zero outside when Q is square.
  void split(const Vector& column, Vector& inside, Vector& outside) const noexcept;

  /// Adds the column that split() took apart; its part outside must not vanish.
  void append(const Vector& inside, const Vector& outside) noexcept;

  /// Takes column `index` away; those after it move up.
  void remove(int index) noexcept;

  /// x <- R^-1 x and x <- R^-T x, count() long.
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
