#pragma once

#include "core/estimation/wrench_innovation.hpp"

namespace palpate::estimation {

/// Innovation of the wrenches of resting hands: its mean since they came to rest and its spread.
/// The errors of the model, which vary with the pose of the hand, are part of that mean, so that a
/// later change reveals external contacts much smaller than these errors. Nothing allocates.
class RestBaseline {
 public:
  explicit RestBaseline(const WrenchSampling& sampling) : sampling_(sampling) {}

  /// A new baseline begins with the next innovation.
  void forget() noexcept { count_ = 0; }
  /// Whether the baseline is long enough for changes to be significant.
  bool is_established() const noexcept { return count_ >= sampling_.updates_in(kLeastTime); }
  /// The same, for an innovation of these hands.
  bool is_established(const std::array<bool, 2>& held) const noexcept {
    return is_established() && held_ == held;
  }

  /// Takes the innovation of an update at rest. Begins a new baseline if the hands with a wrench
  /// have changed.
  void accumulate(const Innovation& now) noexcept;
  /// Includes the last innovation in the baseline. Not while there is an external contact.
  void extend(const Innovation& now) noexcept;

  /// Short-term mean of the innovation minus the baseline, with the covariance of that mean.
  /// Causes: an external contact, sensor noise, or residual oscillation of the object, which
  /// appears in the spread of the wrenches. `states`: number of states other than the contact's
  /// force, on which the change does not depend.
  Innovation change(const Innovation& now, int states) const noexcept;
  /// Last innovation minus the baseline.
  WrenchFilter::Wrenches latest_change() const noexcept { return latest_ - mean_; }
  /// Covariance of a mean of `count` changes: their noise at rest and, for the model error, a
  /// fraction of the wrenches `pushed` that the contact causes.
  WrenchFilter::Noise noise(const WrenchFilter::Wrenches& pushed, int count) const noexcept;
  /// Mean measured wrenches without external contact.
  const WrenchFilter::Wrenches& measured() const noexcept { return measured_; }

  /// The prediction has changed by `off`, because the states were corrected. The mean remains while
  /// there is an external contact, whose force alone is then corrected.
  void follow(const WrenchFilter::Wrenches& off, bool has_contact) noexcept;
  /// The prediction for a hand has changed by `wrench`, because of the external contact alone.
  void follow_contact(int grasp, const math::Vector6d& wrench) noexcept;
  /// The short-term mean starts again from the last innovation.
  void restart_recent() noexcept { recent_ = latest_; }

 private:
  static constexpr double kLeastTime = 0.8;  // s

  WrenchSampling sampling_;
  WrenchFilter::Wrenches mean_;      // of the innovation since the hands came to rest
  WrenchFilter::Wrenches spread_;    // mean square deviation of recent_ from it
  WrenchFilter::Wrenches noise_;     // mean square deviation of latest_ from it
  WrenchFilter::Wrenches measured_;  // mean measured wrenches
  WrenchFilter::Wrenches recent_;    // short-term mean innovation
  WrenchFilter::Wrenches latest_;
  std::array<bool, 2> held_{};  // hands that these rows belong to
  int count_ = 0;
};

}  // namespace palpate::estimation
