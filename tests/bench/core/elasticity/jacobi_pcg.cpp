#include "tests/bench/core/elasticity/jacobi_pcg.hpp"

namespace palpate::bench {

JacobiPcg::JacobiPcg(int unknowns) : inverse_diagonal_(Eigen::Matrix4Xd::Zero(4, unknowns)) {
  r_ = z_ = p_ = q_ = inverse_diagonal_;
}

int JacobiPcg::solve(const BlockRows& A, const Eigen::Matrix4Xd& b, double tolerance,
                     int most_iterations, Eigen::Matrix4Xd& x) {
  for (int i = 0; i < A.size(); ++i) {
    for (int k = A.row_start[i]; k < A.row_start[i + 1]; ++k) {
      if (A.column[k] != i) continue;
      inverse_diagonal_.col(i) << A.blocks[k].diagonal().cwiseInverse(), 0;
    }
  }
  x.setZero();
  r_ = b;
  z_ = inverse_diagonal_.cwiseProduct(r_);
  p_ = z_;
  double rz = r_.cwiseProduct(z_).sum();
  const double limit = tolerance * tolerance * b.squaredNorm();
  int iteration = 0;
  while (iteration < most_iterations && r_.squaredNorm() > limit) {
    A.multiply(p_, q_);
    const double alpha = rz / p_.cwiseProduct(q_).sum();
    x += alpha * p_;
    r_ -= alpha * q_;
    z_ = inverse_diagonal_.cwiseProduct(r_);
    const double next = r_.cwiseProduct(z_).sum();
    p_ = z_ + (next / rz) * p_;
    rz = next;
    ++iteration;
  }
  return iteration;
}

}  // namespace palpate::bench
