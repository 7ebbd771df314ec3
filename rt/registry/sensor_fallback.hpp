#pragma once

#include <memory>

#include "core/sensing/sensor_model.hpp"

namespace palpate::registry {

/// True if no component exceeds a plausible magnitude; larger ones overflow in frame
/// transformations.
bool is_plausible(const sensing::Contact& contact) noexcept;

/// Sensor model with a fallback for the same sensor. Both process all signals, so that the fallback
/// is tared and warmed up when required; only one reports contacts. If the first one faults or
/// reports implausible contacts, the fallback is active until reset(). Whether the fallback is good
/// enough for commanding a robot is decided by the creator of the pair.
class SensorFallback final : public sensing::SensorModel {
 public:
  /// `reason`, a string literal: status reason while the fallback is active, which then counts as
  /// degraded; nullptr: the fallback's own status is used.
  SensorFallback(std::unique_ptr<sensing::SensorModel> first,
                 std::unique_ptr<sensing::SensorModel> second, const char* reason)
      : first_(std::move(first)), second_(std::move(second)), reason_(reason) {}

  UpdateResult update(const sensing::Signals& signals,
                      sensing::ContactSet& contacts) noexcept override;
  void zero() noexcept override;
  void reset() noexcept override;
  sensing::SensorState save() const noexcept override { return first_->save(); }
  bool restore(const sensing::SensorState& state) noexcept override {
    return first_->restore(state) && second_->restore(state);
  }
  bool in_use() const noexcept { return in_use_; }
  /// Set-up: replaces the first model and returns the previous one.
  void exchange(std::unique_ptr<sensing::SensorModel>& first) noexcept { first_.swap(first); }
  const sensing::Executor* executor(int index) const noexcept override {
    return first_->executor(index);
  }

 private:
  std::unique_ptr<sensing::SensorModel> first_, second_;
  const char* reason_;
  bool in_use_ = false;
  sensing::ContactSet unused_;
};

}  // namespace palpate::registry
