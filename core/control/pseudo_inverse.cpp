#include "core/control/pseudo_inverse.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace palpate::control {

bool is_rotation_row(const shape::Feature& feature, int row) noexcept {
  return std::strcmp(feature.kind(), "pose") == 0 && row >= 3;
}

PseudoInverse::PseudoInverse(const Options& options) : options_(options) {
  if (!(options.length > 0 && options.length < 1e3)) {
    throw std::invalid_argument("length of the pseudo-inverse must be positive");
  }
  if (!(options.damping >= 0 && options.damping < 1)) {
    throw std::invalid_argument("damping of the pseudo-inverse must lie in [0, 1)");
  }
  if (!(options.rank_tolerance >= 1e-6 && options.rank_tolerance < 1)) {
    throw std::invalid_argument("rank tolerance of the pseudo-inverse must lie in [1e-6, 1)");
  }
}

void PseudoInverse::set_up(const shape::Feature& feature) {
  const int rows = feature.dimension();
  row_scale_.setOnes(rows);
  for (int row = 0; row < rows; ++row) {
    if (is_rotation_row(feature, row)) row_scale_[row] = options_.length;
  }
  scaled_.setZero(rows);
  J_.setZero(rows, 6);
}

bool PseudoInverse::decompose(const Eigen::MatrixXd& J) noexcept {
  lambda_.setZero();
  if (!J.allFinite()) return false;
  J_ = row_scale_.asDiagonal() * J;
  J_.rightCols<3>() /= options_.length;
  const math::Matrix6d normal = J_.transpose().lazyProduct(J_);
  if (!normal.allFinite()) return false;
  const Eigen::SelfAdjointEigenSolver<math::Matrix6d> solver(normal);
  if (solver.info() != Eigen::Success || !(solver.eigenvalues()[5] > 1e-18)) return false;
  V_ = solver.eigenvectors();
  lambda_ = solver.eigenvalues();
  return true;
}

math::Twist PseudoInverse::solve(const Eigen::VectorXd& s) noexcept {
  const double floor = options_.damping * options_.damping * lambda_[5];
  scaled_ = row_scale_.cwiseProduct(s);
  math::Vector6d along = V_.transpose() * math::Vector6d(J_.transpose().lazyProduct(scaled_));
  for (int i = 0; i < 6; ++i) {
    // Singular values below 1e-6 of the largest drown in the rounding of the normal matrix.
    along[i] = lambda_[i] > 1e-12 * lambda_[5] ? along[i] / std::max(lambda_[i], floor) : 0.0;
  }
  math::Vector6d u = V_ * along;
  u.tail<3>() /= options_.length;
  return math::Twist::from(u);
}

void PseudoInverse::unreachable(const Eigen::VectorXd& e, Eigen::VectorXd& out) noexcept {
  const double floor = options_.rank_tolerance * options_.rank_tolerance * lambda_[5];
  scaled_ = row_scale_.cwiseProduct(e);
  math::Vector6d along = V_.transpose() * math::Vector6d(J_.transpose().lazyProduct(scaled_));
  for (int i = 0; i < 6; ++i) along[i] = lambda_[i] > floor ? along[i] / lambda_[i] : 0.0;
  const math::Vector6d u = V_ * along;
  scaled_ -= J_.lazyProduct(u);
  out = scaled_.cwiseQuotient(row_scale_);
}

}  // namespace palpate::control
