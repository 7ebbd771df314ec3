#pragma once

#include <algorithm>
#include <cmath>

#include "core/elasticity/deformation_model.hpp"
#include "core/math/update_result.hpp"
#include "core/sensing/sensor_model.hpp"

namespace palpate::estimation {

/// Converts the step reports of an incremental model into a status. A moving model seldom converges
/// within one tick and may wait for a factorisation; both are reported only when they persist.
class StepWatch {
 public:
  struct Options {
    double residual = 0.05;  // N, residual of a step below which it counts as converged
    double patience = 0.5;   // s, duration of a problem before it is reported, or latched
  };

  explicit StepWatch(const Options& options) : options_(options) {}

  UpdateResult judge(const elasticity::StepReport& report, double dt) noexcept {
    using elasticity::StepStatus;
    const bool failed = report.status == StepStatus::kFailed;
    const bool unbalanced =
        report.status == StepStatus::kNotConverged && !(report.residual <= options_.residual);
    failed_for_ = failed ? failed_for_ + dt : 0;
    unbalanced_for_ = unbalanced ? unbalanced_for_ + dt : 0;
    if (failed_for_ > options_.patience) {
      return {Status::kFault, "deformation model keeps failing"};
    }
    if (failed) return {Status::kDegraded, "deformation model failed in this step"};
    if (unbalanced_for_ > options_.patience) {
      return {Status::kDegraded, "deformation model does not converge"};
    }
    return {};
  }

  void reset() noexcept { failed_for_ = unbalanced_for_ = 0; }

 private:
  Options options_;
  double failed_for_ = 0;
  double unbalanced_for_ = 0;
};

/// Provides a valid time step to the model: the last valid one if `dt` is not positive and finite.
class StepGuard {
 public:
  bool accepts(double dt) noexcept {
    const bool good = std::isfinite(dt) && dt > 0;
    if (good) last_ = dt;
    return good;
  }
  double step() const noexcept { return last_; }

 private:
  double last_ = 1e-3;  // s
};

}  // namespace palpate::estimation
