#include "core/control/pseudo_inverse.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <stdexcept>

#include "core/math/option_check.hpp"

namespace palpate::control {

PseudoInverse::PseudoInverse(const Options& options) : options_(options) {
  using math::check_option;
  check_option(options.length > 0 && options.length < 1e3, "characteristic_length", options.length,
               "above 0 to below 1000");
  check_option(options.damping >= 0 && options.damping < 1, "damping", options.damping,
               "0 to below 1");
  check_option(options.rank_tolerance >= 1e-6 && options.rank_tolerance < 1, "rank_tolerance",
               options.rank_tolerance, "1e-6 to below 1");
  check_option(options.grasps >= 1 && options.grasps <= 2, "grasps", options.grasps, "1 or 2");
  V_ = Normal::Identity(columns(), columns());
  lambda_ = Motion::Zero(columns());
  column_scale_ = Motion::Ones(columns());
  for (int g = 0; g < options.grasps; ++g) {
    column_scale_.segment<3>(6 * g + 3).setConstant(1 / options.length);
  }
}

void PseudoInverse::set_up(const shape::Feature& feature) {
  const int rows = feature.dimension();
  row_scale_.setOnes(rows);
  for (int row = 0; row < rows; ++row) {
    if (feature.unit(row) == shape::Unit::kRadian) row_scale_[row] = options_.length;
    if (feature.unit(row) == shape::Unit::kPerMetre) {
      row_scale_[row] = options_.length * options_.length;
    }
  }
  scaled_.setZero(rows);
  J_.setZero(rows, columns());
}

bool PseudoInverse::decompose(const Eigen::MatrixXd& J) noexcept {
  lambda_.setZero();
  if (J.cols() != columns() || !J.allFinite()) return false;
  J_ = row_scale_.asDiagonal() * J * column_scale_.asDiagonal();
  const Normal normal = J_.transpose().lazyProduct(J_);
  if (!normal.allFinite()) return false;
  const Eigen::SelfAdjointEigenSolver<Normal> solver(normal);
  if (solver.info() != Eigen::Success || !(solver.eigenvalues()[columns() - 1] > 1e-18)) {
    return false;
  }
  V_ = solver.eigenvectors();
  lambda_ = solver.eigenvalues();
  return true;
}

PseudoInverse::Motion PseudoInverse::solve(const Eigen::VectorXd& s) noexcept {
  const double floor = options_.damping * options_.damping * greatest();
  scaled_ = row_scale_.cwiseProduct(s);
  Motion along = V_.transpose().lazyProduct(Motion(J_.transpose().lazyProduct(scaled_)));
  for (int i = 0; i < columns(); ++i) {
    // Singular values below 1e-6 of the largest are below the rounding errors of the normal matrix.
    along[i] = lambda_[i] > 1e-12 * greatest() ? along[i] / std::max(lambda_[i], floor) : 0.0;
  }
  return column_scale_.cwiseProduct(V_.lazyProduct(along));
}

void PseudoInverse::unreachable(const Eigen::VectorXd& e, Eigen::VectorXd& out) noexcept {
  const double floor = options_.rank_tolerance * options_.rank_tolerance * greatest();
  scaled_ = row_scale_.cwiseProduct(e);
  Motion along = V_.transpose().lazyProduct(Motion(J_.transpose().lazyProduct(scaled_)));
  for (int i = 0; i < columns(); ++i) along[i] = lambda_[i] > floor ? along[i] / lambda_[i] : 0.0;
  const Motion u = V_.lazyProduct(along);
  scaled_ -= J_.lazyProduct(u);
  out = scaled_.cwiseQuotient(row_scale_);
}

}  // namespace palpate::control
