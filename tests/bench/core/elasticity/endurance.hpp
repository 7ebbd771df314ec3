#pragma once

#include <ostream>

#include "tests/bench/core/elasticity/refactor_service.hpp"
#include "tests/bench/core/elasticity/scenario.hpp"

namespace palpate::bench {

struct EnduranceOptions {
  long steps = 1000000;
  long segment_steps = 5000;
  long first_segment = 0;            // to repeat one segment: each has its own stream of the seed
  double budget = 1e-3;              // s of thread time
  double most_load = 100;            // times a reasonable one
  elasticity::SolverOptions solver;  // tolerance at E = 1e5 Pa, in proportion to E elsewhere
  RefactorPolicy refactor{RefactorPolicy::kDelayed, 10};
  std::uint64_t seed = 1;
};

/// Segments of random loads, random gravity and two grasps held, moved and released at random, with
/// E from 1e3 to 1e9 Pa, over linear and quadratic, dynamic and quasi-static models in turn; after
/// each the body is released and must return to rest. Prints a table by model and modulus; false
/// after a non-finite number or a leak.
bool run_endurance(const EnduranceOptions& options, std::ostream& out);

}  // namespace palpate::bench
