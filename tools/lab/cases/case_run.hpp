#pragma once

#include "core/elasticity/corotational_model.hpp"
#include "tools/lab/cases/case_problem.hpp"

namespace palpate::cases {

inline constexpr double kTick = 1e-3;  // s

/// What the steps of an incremental model cost.
struct StepTimes {
  int ticks = 0;
  double p50 = 0;  // us of the thread's processor time
  double p99 = 0;
  double iterations = 0;  // mean of a step
  int most_iterations = 0;
  int refactorisations = 0;
};

/// The co-rotational equilibrium by Newton's method, to a tolerance that suits the stiffness.
elasticity::StaticSolution solve(const CaseProblem& problem);

struct IncrementalRun {
  StepTimes times;         // while the load rises
  bool converged = false;  // some ticks after it has risen
  double deviation = 0;    // m, of the node farthest from where it should be
};

/// The quasi-static model at 1 ms while loads, weight and hand rise evenly for `ticks`, then until
/// it rests (at most as long again). A factor that it asks for is made between two ticks, untimed.
IncrementalRun run_incremental(const CaseProblem& problem, const Eigen::Matrix3Xd& equilibrium,
                               int ticks, const elasticity::SolverOptions& options = {});

struct DynamicOptions {
  std::optional<double> mass_damping;  // 1/s; without: critical for the first mode, estimated
  double stiffness_damping = 0;        // s
  double rise = 0;                     // s over which loads, weight and hand rise; 0: at once
  double seconds = 20;                 // at most
};

struct DynamicRun {
  StepTimes times;
  bool at_rest = false;
  double mass_damping = 0;   // 1/s, as used
  double seconds = 0;        // simulated until at rest
  double settling_time = 0;  // s, from when on no node is 1 % of the largest displacement away
  double deviation = 0;      // m, at the end, of the node farthest from `equilibrium`
  Eigen::Matrix3Xd positions;
  math::Wrench grasp;
};

/// The dynamic model at 1 ms from rest shape to rest under the load.
DynamicRun run_dynamic(const CaseProblem& problem, const elasticity::StaticSolution& equilibrium,
                       const DynamicOptions& options);

}  // namespace palpate::cases
