#pragma once

#include <memory>

#include "tests/bench/core/elasticity/baseline_system.hpp"

namespace palpate::bench {

/// Supernodal Cholesky factorisation by CHOLMOD, in the better of METIS' nested dissection and AMD
/// on the graph of nodes; analysis once.
class CholmodSolver {
 public:
  explicit CholmodSolver(const BlockRows& pattern);
  ~CholmodSolver();

  /// False if the matrix is not positive definite.
  bool factorise(const BlockRows& A);
  /// 4 x n, row 3 of x zero.
  void solve(const Eigen::Matrix4Xd& b, Eigen::Matrix4Xd& x);

  double factor_entries() const;  // scalars in L

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace palpate::bench
