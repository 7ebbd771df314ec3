#pragma once

#include <memory>

#include "core/elasticity/contact/contact_options.hpp"
#include "core/elasticity/element_forces.hpp"
#include "core/factor/solve_panels.hpp"
#include "core/factor/supernodal_factor.hpp"
#include "core/math/team.hpp"

namespace palpate::elasticity {

struct SolverOptions {
  int iterations = 2;       // maximum number of quasi-Newton corrections per step, >= 1
  double tolerance = 1e-6;  // N, largest unbalanced nodal force at which a step ends early
  double accuracy = 1e-7;   // m, a step also ends if the next correction would move no node by more
  // Whether forces are evaluated once more after a correction that is expected to end a step.
  // Without it a step costs one evaluation less; forces (including reactions) and energy are then
  // those before its last correction, and the reported residual is an estimate.
  bool confirm = true;
  // Number of sensitivity columns that a quasi-static step also corrects, in turn, each for the
  // cost of two evaluations and a solve. During a large motion, with factors 30 ms old, the error
  // of the columns is 6 % without correction, about 2 % if each is corrected in every step (6), 0.3
  // % if twice (12).
  int refine = 0;
  int halvings = 4;                          // maximum number of halvings of one correction
  double time_step = 1e-3;                   // s, time step of the factor that prepare() computes
  Precision precision = Precision::kDouble;  // arithmetic inside elements
  factor::PanelPrecision panels = factor::PanelPrecision::kSingle;  // storage of the factor
  factor::FactorMaker make_factor = factor::make_own_factor;        // of the background job
  factor::Orders orders = nullptr;  // more candidates for the elimination order
  // Conditions for requesting a new factor:
  double turned = 0.02;      // rad, largest rotation of a node since the snapshot
  double contraction = 0.3;  // fraction of the residual that remains after a correction
  // A step stops correcting after `budget` seconds of `clock` (s, monotonic), if set.
  double budget = 0;
  double (*clock)() = nullptr;
  ContactOptions contact;  // obstacles that the object may touch
  // Threads that share the work of a step; without a team the calling thread alone. The team's size
  // determines the summation order and thus the last bits.
  std::shared_ptr<math::Team> team = nullptr;
};

inline math::Team& team_of(const SolverOptions& options) noexcept {
  return options.team != nullptr ? *options.team : math::solo_team;
}

/// Time limit of a step, counted from construction.
class StepBudget {
 public:
  /// `options` must outlive this object.
  explicit StepBudget(const SolverOptions& options) noexcept
      : options_(options), start_(options.clock != nullptr ? options.clock() : 0) {}

  bool is_spent() const noexcept {
    return options_.clock != nullptr && options_.clock() - start_ > options_.budget;
  }

 private:
  const SolverOptions& options_;
  double start_;  // s
};

}  // namespace palpate::elasticity
