#include "core/elasticity/block_ldl.hpp"

#include <Eigen/LU>

namespace palpate::elasticity {
namespace {

/// Inverse of a symmetric 3 x 3 pivot; false where it is not positive beyond rounding of `scale`.
bool invert_pivot(const Eigen::Matrix3d& pivot, double scale, Eigen::Matrix3d& inverse) {
  const double floor = 1e-11 * scale;
  const double d0 = pivot(0, 0);
  if (!(d0 > floor)) return false;
  const double l1 = pivot(1, 0) / d0, l2 = pivot(2, 0) / d0;
  const double d1 = pivot(1, 1) - l1 * pivot(1, 0);
  if (!(d1 > floor)) return false;
  const double m = pivot(2, 1) - l2 * pivot(1, 0);
  const double d2 = pivot(2, 2) - l2 * pivot(2, 0) - m * m / d1;
  if (!(d2 > floor)) return false;
  const double l3 = m / d1;
  Eigen::Matrix3d inverse_l;
  inverse_l << 1, 0, 0, -l1, 1, 0, l1 * l3 - l2, -l3, 1;
  inverse.noalias() =
      inverse_l.transpose() * Eigen::Vector3d(1 / d0, 1 / d1, 1 / d2).asDiagonal() * inverse_l;
  return true;
}

}  // namespace

BlockLdl::BlockLdl(const BlockPattern& pattern)
    : parent_(pattern.size(), -1),
      column_start_(pattern.size() + 1, 0),
      inverse_pivots_(pattern.size(), Eigen::Matrix3d::Identity()),
      filled_(pattern.size(), 0),
      flag_(pattern.size(), -1),
      stack_(pattern.size(), 0),
      y_(pattern.size(), Padded::Zero()) {
  const int n = pattern.size();
  std::vector<int> count(n, 0);
  upper_.resize(n);
  for (int k = 0; k < n; ++k) {
    for (int s = pattern.column_start()[k]; s < pattern.column_start()[k + 1]; ++s) {
      upper_[pattern.row()[s]].emplace_back(k, s);
    }
  }
  for (int k = 0; k < n; ++k) {
    flag_[k] = k;
    for (const auto& [first, s] : upper_[k]) {
      for (int i = first; flag_[i] != k; i = parent_[i]) {
        if (parent_[i] < 0) parent_[i] = k;
        ++count[i];
        flag_[i] = k;
      }
    }
  }
  for (int k = 0; k < n; ++k) column_start_[k + 1] = column_start_[k] + count[k];
  row_.resize(column_start_[n]);
  lower_.assign(column_start_[n], Padded::Zero());
}

bool BlockLdl::factorise(const BlockMatrix& A, const std::vector<char>& held,
                         double shift) noexcept {
  const int n = size();
  std::fill(flag_.begin(), flag_.end(), -1);
  std::fill(filled_.begin(), filled_.end(), 0);
  for (int k = 0; k < n; ++k) {
    // Pattern of row k of L in topological order, by walks up the elimination tree.
    int top = n;
    flag_[k] = k;
    y_[k].setZero();
    double scale = 1;
    for (const auto& [first, s] : upper_[k]) {
      int i = first;
      if (i == k) {
        if (held[k]) {
          y_[k].topRows<3>().setIdentity();
        } else {
          y_[k].topRows<3>() = A.block(s);
          y_[k].topRows<3>().diagonal().array() += shift;
          scale = y_[k].topRows<3>().diagonal().maxCoeff();
        }
        continue;
      }
      if (held[k] || held[i]) {
        y_[i].setZero();
      } else {
        y_[i].topRows<3>() = A.block(s).transpose();
      }
      int length = 0;
      for (; flag_[i] != k; i = parent_[i]) {
        stack_[length++] = i;
        flag_[i] = k;
      }
      while (length > 0) stack_[--top] = stack_[--length];
    }
    Eigen::Matrix3d pivot = y_[k].topRows<3>();
    y_[k].setZero();
    for (; top < n; ++top) {
      const int i = stack_[top];
      const Eigen::Matrix3d y = y_[i].topRows<3>();
      y_[i].setZero();
      const int end = column_start_[i] + filled_[i];
      for (int p = column_start_[i]; p < end; ++p) {
        y_[row_[p]].noalias() -= lower_[p].lazyProduct(y);
      }
      const Eigen::Matrix3d l = y.transpose() * inverse_pivots_[i];
      pivot.noalias() -= l * y;
      row_[end] = k;
      lower_[end].topRows<3>() = l;
      ++filled_[i];
    }
    if (!invert_pivot(pivot, scale, inverse_pivots_[k])) {
      for (Padded& y : y_) y.setZero();
      return false;
    }
  }
  return true;
}

void BlockLdl::solve(Eigen::Matrix4Xd& b) const noexcept {
  const int n = size();
  for (int k = 0; k < n; ++k) {
    const Eigen::Vector3d z = b.col(k).head<3>();
    for (int p = column_start_[k]; p < column_start_[k + 1]; ++p) {
      b.col(row_[p]).noalias() -= lower_[p].lazyProduct(z);
    }
  }
  for (int k = n - 1; k >= 0; --k) {
    Padded sums = Padded::Zero();
    for (int p = column_start_[k]; p < column_start_[k + 1]; ++p) {
      const Eigen::Vector4d x = b.col(row_[p]);
      for (int j = 0; j < 3; ++j) sums.col(j) += lower_[p].col(j).cwiseProduct(x);
    }
    const Eigen::Vector3d z = inverse_pivots_[k] * b.col(k).head<3>();
    for (int j = 0; j < 3; ++j) b(j, k) = z(j) - sums.col(j).sum();
  }
}

}  // namespace palpate::elasticity
