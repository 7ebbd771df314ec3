#pragma once

#include "core/elasticity/corotational_model.hpp"
#include "tools/lab/cases/case_problem.hpp"

namespace palpate::cases {

inline constexpr double kTick = 1e-3;  // s

/// Computation cost of the steps of an incremental model.
struct StepTimes {
  int ticks = 0;
  double p50 = 0;  // us of the thread's processor time
  double p99 = 0;
  double iterations = 0;  // mean per step
  int most_iterations = 0;
  int refactorisations = 0;
};

/// The co-rotational equilibrium by Newton's method, to a tolerance suited to the stiffness.
elasticity::StaticSolution solve(const CaseProblem& problem);

struct IncrementalRun {
  StepTimes times;         // while the load rises
  bool converged = false;  // a few ticks after it has risen
  double deviation = 0;    // m, maximum distance of a node from the equilibrium
};

/// The quasi-static model at 1 ms while loads, weight and hand ramp linearly over `ticks`, then
/// until it rests (at most as long again). A factorisation that it requests is computed between two
/// ticks, untimed.
IncrementalRun run_incremental(const CaseProblem& problem, const Eigen::Matrix3Xd& equilibrium,
                               int ticks, const elasticity::SolverOptions& options = {});

struct DynamicOptions {
  std::optional<double> mass_damping;  // 1/s; if unset: critical for the first mode, estimated
  double stiffness_damping = 0;        // s
  double rise = 0;                     // s, ramp time of loads, weight and hand; 0: immediately
  double seconds = 20;                 // at most
};

struct DynamicRun {
  StepTimes times;
  bool at_rest = false;
  double mass_damping = 0;  // 1/s, as used
  double seconds = 0;       // simulated until at rest
  double settling_time =
      0;  // s, after which no node is farther off than 1 % of the largest displacement
  double deviation = 0;  // m, at the end, maximum distance of a node from `equilibrium`
  Eigen::Matrix3Xd positions;
  math::Wrench grasp;
};

/// The dynamic model at 1 ms from the rest shape to rest under the load.
DynamicRun run_dynamic(const CaseProblem& problem, const elasticity::StaticSolution& equilibrium,
                       const DynamicOptions& options);

}  // namespace palpate::cases
