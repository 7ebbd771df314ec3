#pragma once

#include <array>

#include "core/control/discrepancy_policy.hpp"
#include "core/estimation/estimator.hpp"
#include "rt/pipeline/life_cycle.hpp"

namespace palpate::pipeline {

/// Whether control may use the estimate of this tick, and whether its policy for discrepancies
/// applies. The wrenches contradict the model where the estimator says so, by its result
/// (kDoubtful) or by its report. An estimate that is in doubt is used as the policy permits; one
/// that is degraded for another reason is not used at all. Nothing allocates.
class EstimateTrust {
 public:
  /// Applies the estimator's result to its slot's condition. A discrepancy makes it degraded; the
  /// reason then ends with what control does about it. It points into this object.
  void judge(const UpdateResult& result, const estimation::Estimate& estimate,
             const control::DiscrepancyPolicy::Options& policy, Condition& condition) noexcept;

  /// False if the estimate must not move the robot.
  bool is_usable() const noexcept { return is_usable_; }
  /// Whether the wrenches contradict the model and no external contact explains it.
  bool is_in_doubt() const noexcept { return is_in_doubt_; }
  /// Reason of the discrepancy, and what control does about it; as of the last one.
  const char* reason() const noexcept { return text_.data(); }
  void reset() noexcept { is_usable_ = is_in_doubt_ = false; }

 private:
  bool is_usable_ = false, is_in_doubt_ = false;
  std::array<char, 200> text_{};
};

}  // namespace palpate::pipeline
