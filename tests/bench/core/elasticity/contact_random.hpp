#pragma once

#include <cstdint>
#include <ostream>

namespace palpate::bench {

struct RandomContactOptions {
  long steps = 1000000;
  long segment_steps = 2000;
  long first_segment = 0;  // to repeat one segment: each has its own stream of the seed
  int delay = 10;          // steps between a snapshot and its factor
  double budget = 1e-3;    // s of thread time
  std::uint64_t seed = 1;
};

/// Segments of a bar that a hand presses against random obstacles and drags over them, at up to 50
/// mm/s, with friction from 0 to 1.2 and E from 1e3 to 1e9 Pa, over linear and quadratic,
/// quasi-static and dynamic models in turn. Prints a table by model and modulus with progress on
/// the standard error; false after a number that is not finite, an allocation in a step, or a point
/// of the surface that passes through an obstacle.
bool run_random_contact(const RandomContactOptions& options, std::ostream& out);

}  // namespace palpate::bench
