#pragma once

#include <Eigen/Core>
#include <memory>

#include "core/math/quadratic_program.hpp"

namespace palpate::bench {

/// The quadprog package of R (B. A. Turlach's Fortran code of the method of Goldfarb and Idnani),
/// called without R, if Debian's r-cran-quadprog is installed. It supports neither warm start nor
/// soft or two-sided rows.
class QuadprogPeer {
 public:
  /// Null if it is not installed.
  static std::unique_ptr<QuadprogPeer> open();

  /// Hard rows only.
  void load(const math::QuadraticProgram& program);
  /// False if it finds the rows contradictory. Overwrites the loaded program.
  bool solve();
  const Eigen::VectorXd& u() const { return u_; }

 private:
  using Solve = void (*)(double* H, double* g, const int* leading, const int* variables, double* u,
                         double* multipliers, double* value, double* rows, double* bounds,
                         const int* leading_rows, const int* row_count, const int* equations,
                         int* active, int* active_count, int* iterations, double* work, int* error);
  explicit QuadprogPeer(Solve routine) : solve_(routine) {}

  Solve solve_;
  Eigen::MatrixXd H_, rows_;
  Eigen::VectorXd g_, bounds_, u_, multipliers_, work_;
  Eigen::VectorXi active_;
  int equations_ = 0;
};

}  // namespace palpate::bench
