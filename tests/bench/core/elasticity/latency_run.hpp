#pragma once

#include <functional>

#include "tests/bench/core/elasticity/refactor_service.hpp"
#include "tests/bench/core/elasticity/scenario.hpp"

namespace palpate::bench {

struct LatencyOptions {
  BarMesh mesh;
  Motion motion = Motion::kLarge;
  Mechanics mechanics = Mechanics::kDynamic;
  double young_modulus = 1e5;  // Pa
  std::string
      law;  // of Scenario; with a law `checks` and `baselines`, which are linear, must be off
  elasticity::SolverOptions solver;  // iterations, tolerance
  RefactorPolicy refactor;
  double dt = 1e-3;      // s
  long warm_up = 200;    // steps before the first sample
  long steps = 10000;    // sampled at most
  double seconds = 1e9;  // of wall time at most, from the first sample on
  int checks = 200;      // steps compared with a converged solve and the baselines
  bool baselines = false;
  bool paced = false;  // a step begins every dt, as in the daemon, instead of without pause
  std::function<void()> schedule;  // of the stepping thread, set after its helpers have started
};

/// Times in s.
struct StepTimes {
  Samples wall, cpu;
};

struct BaselineResult {
  StepTimes times;
  Samples assembly;    // thread time of the evaluation of forces and tangent
  Samples iterations;  // of the linear solver
  double error = 0;    // like LatencyResult::error
  long failed = 0;
};

struct LatencyResult {
  StepTimes step;
  Samples iterations;
  long not_converged = 0, failed = 0;
  /// Largest distance of a node from the converged solution of the same step (Newton's method of
  /// the baselines, from the state before the step), over all checks but `unknown` ones, relative
  /// to `amplitude`, the largest displacement of the run.
  double error = 0;
  double amplitude = 0;  // m
  int checks = 0;
  int unknown = 0;  // checks whose solve did not converge: the state was invalid before
  long refactorisations = 0;
  Samples refactor_wall, refactor_cpu;
  Samples factor_age, sensitivity_age;  // s, at each step; the second only if valid
  BaselineResult cholmod, pcg;
};

LatencyResult run_latency(const LatencyOptions& options);

}  // namespace palpate::bench
