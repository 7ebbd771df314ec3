#pragma once

#include "tests/bench/core/elasticity/baseline_system.hpp"

namespace palpate::bench {

/// Conjugate gradients preconditioned by the diagonal, as the 2018 system solved its linear
/// systems.
class JacobiPcg {
 public:
  explicit JacobiPcg(int unknowns);

  /// Solves A x = b from x = 0 until |r| <= tolerance |b|; the iterations taken.
  int solve(const BlockRows& A, const Eigen::Matrix4Xd& b, double tolerance, int most_iterations,
            Eigen::Matrix4Xd& x);

 private:
  Eigen::Matrix4Xd inverse_diagonal_, r_, z_, p_, q_;
};

}  // namespace palpate::bench
