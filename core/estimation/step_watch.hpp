#pragma once

#include <algorithm>
#include <cmath>

#include "core/elasticity/deformation_model.hpp"
#include "core/sensing/sensor_model.hpp"

namespace palpate::estimation {

/// Turns the reports of an incremental model into a status. A moving model seldom converges within
/// one tick and may wait for a factor; neither counts as trouble until it lasts.
class StepWatch {
 public:
  struct Options {
    double residual = 0.05;  // N, a step out of balance by less than this is good enough
    double patience = 0.5;   // s that trouble may last before it is reported, or latched
  };

  explicit StepWatch(const Options& options) : options_(options) {}

  sensing::UpdateResult judge(const elasticity::StepReport& report, double dt) noexcept {
    using elasticity::StepStatus;
    const bool failed = report.status == StepStatus::kFailed;
    const bool unbalanced =
        report.status == StepStatus::kNotConverged && !(report.residual <= options_.residual);
    failed_for_ = failed ? failed_for_ + dt : 0;
    unbalanced_for_ = unbalanced ? unbalanced_for_ + dt : 0;
    if (failed_for_ > options_.patience) {
      return {sensing::Status::kFault, "deformation model keeps failing"};
    }
    if (failed) return {sensing::Status::kDegraded, "deformation model failed in this step"};
    if (unbalanced_for_ > options_.patience) {
      return {sensing::Status::kDegraded, "deformation model does not converge"};
    }
    return {};
  }

  void reset() noexcept { failed_for_ = unbalanced_for_ = 0; }

 private:
  Options options_;
  double failed_for_ = 0;
  double unbalanced_for_ = 0;
};

/// The step that a model may be given: the last good one where `dt` is not positive and finite.
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
