#pragma once

#include <ostream>

#include "tests/bench/core/elasticity/refactor_service.hpp"
#include "tests/bench/core/elasticity/scenario.hpp"

namespace palpate::bench {

enum class Start {
  kMirrored,  // every free node mirrored through the clamp: all elements inverted
  kRandom,    // every free node anywhere within the bar's box
};

struct RecoveryOptions {
  BarMesh mesh;
  Mechanics mechanics = Mechanics::kDynamic;
  Start start = Start::kMirrored;
  double young_modulus = 1e5;  // Pa
  double mass_damping = 2;     // 1/s
  elasticity::SolverOptions solver;
  RefactorPolicy refactor{RefactorPolicy::kDelayed, 10};
  double seconds = 20;  // simulated, at most; in statics a thousand steps each
  std::uint64_t seed = 1;
  std::string only;  // of run_recoveries: lines whose name holds this text
};

struct RecoveryResult {
  bool is_recovered = false;  // permanently no inverted point and within kRest of rest
  bool is_finite = true;
  double untangled_at = -1;  // s, simulated, after which nothing was inverted; -1: never
  double at_rest =
      -1;            // s, after which every node was within kRest of its rest position; -1: never
  int inverted = 0;  // quadrature points, at the end
  double error = 0;  // m, largest distance of a node from rest, at the end
  long steps = 0, failed = 0, refactorisations = 0;
  double slowest_step = 0;  // s, thread time
  double total = 0;         // s, wall time, including factorisations
};

inline constexpr double kRest = 1e-6;  // m

/// From an invalid state, clamp held and no loads, back to rest.
RecoveryResult run_recovery(const RecoveryOptions& options);

/// Runs every combination of start, mechanics and the meshes of about 300 and 1000 nodes, prints
/// each line as it completes, and returns the number of failed recoveries.
int run_recoveries(const RecoveryOptions& common, std::ostream& out);

}  // namespace palpate::bench
