#include "core/math/quadratic_program.hpp"

#include <cmath>

namespace palpate::math {

void ColumnFactor::clear(int length) noexcept {
  length_ = length;
  count_ = 0;
  Q_.resize(length, kMost);
}

void ColumnFactor::split(const Vector& column, Vector& inside, Vector& outside) const noexcept {
  inside.setZero(count_);
  outside = column;
  const double size = column.squaredNorm();
  for (int pass = 0; pass < 2; ++pass) {
    // a remainder of comparable size has lost no digits
    if (pass > 0 && outside.squaredNorm() > 0.5 * size) break;
    for (int k = 0; k < count_; ++k) {
      const double along = Q_.col(k).dot(outside);
      inside[k] += along;
      outside -= along * Q_.col(k);
    }
  }
  if (count_ == length_) outside.setZero();
}

void ColumnFactor::append(const Vector& inside, const Vector& outside) noexcept {
  const double norm = outside.norm();
  R_.col(count_).head(count_) = inside;
  R_(count_, count_) = norm;
  Q_.col(count_) = outside / norm;
  ++count_;
}

void ColumnFactor::remove(int index) noexcept {
  for (int k = index + 1; k < count_; ++k) R_.col(k - 1).head(k + 1) = R_.col(k).head(k + 1);
  --count_;
  // Rotates rows k and k + 1 so that the entry below the diagonal vanishes, and Q by the inverse.
  for (int k = index; k < count_; ++k) {
    const double length = std::hypot(R_(k, k), R_(k + 1, k));
    const double c = R_(k, k) / length;
    const double s = R_(k + 1, k) / length;
    for (int j = k; j < count_; ++j) {
      const double upper = R_(k, j);
      const double lower = R_(k + 1, j);
      R_(k, j) = c * upper + s * lower;
      R_(k + 1, j) = c * lower - s * upper;
    }
    for (int i = 0; i < length_; ++i) {
      const double left = Q_(i, k);
      const double right = Q_(i, k + 1);
      Q_(i, k) = c * left + s * right;
      Q_(i, k + 1) = c * right - s * left;
    }
  }
}

void ColumnFactor::solve(Vector& x) const noexcept {
  for (int k = count_ - 1; k >= 0; --k) {
    x[k] /= R_(k, k);
    x.head(k) -= x[k] * R_.col(k).head(k);
  }
}

void ColumnFactor::solve_transposed(Vector& x) const noexcept {
  for (int k = 0; k < count_; ++k) x[k] = (x[k] - R_.col(k).head(k).dot(x.head(k))) / R_(k, k);
}

}  // namespace palpate::math
