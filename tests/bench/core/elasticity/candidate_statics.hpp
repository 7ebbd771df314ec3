#pragma once

#include "core/elasticity/static_solver.hpp"
#include "tests/bench/core/elasticity/candidate_elements.hpp"

namespace palpate::bench {

struct CandidateSolution {
  bool converged = false;
  Eigen::Matrix3Xd positions;  // 3 x n, m
};

/// Static equilibrium of a body of candidate elements, by Newton's method with a line search; the
/// load is divided into more steps on failure. loads: 3 x n, N, complete: gravity is not added.
/// Grasped nodes move with `held` (unheld grasps are free).
CandidateSolution solve_candidate(const elasticity::Body& body, Volumetric volumetric,
                                  const Eigen::Matrix3Xd& loads,
                                  const elasticity::HeldPoses& held = {});

}  // namespace palpate::bench
