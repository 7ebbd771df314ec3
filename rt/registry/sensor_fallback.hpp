#pragma once

#include <memory>

#include "core/sensing/sensor_model.hpp"

namespace palpate::registry {

/// What is larger overflows where wrenches change their frame.
bool is_plausible(const sensing::Contact& contact) noexcept;

/// A sensor model with another one of the same sensor to fall back on. Both see all signals, so
/// that the second is tared and warm when it is wanted; only one of them reports contacts. Where
/// the first faults, or reports what cannot be, the second goes on until reset().
/// Whether the second is as good as the first, so that what it feels may move a robot, is for who
/// makes the pair to say.
class SensorFallback final : public sensing::SensorModel {
 public:
  /// `reason`, a string literal: what to say while the fallback runs, which then counts as
  /// degraded; nullptr: it counts as what it says itself.
  SensorFallback(std::unique_ptr<sensing::SensorModel> first,
                 std::unique_ptr<sensing::SensorModel> second, const char* reason)
      : first_(std::move(first)), second_(std::move(second)), reason_(reason) {}

  sensing::UpdateResult update(const sensing::Signals& signals,
                               sensing::ContactSet& contacts) noexcept override;
  void zero() noexcept override;
  void reset() noexcept override;
  sensing::SensorState save() const noexcept override { return first_->save(); }
  bool restore(const sensing::SensorState& state) noexcept override {
    return first_->restore(state) && second_->restore(state);
  }
  bool in_use() const noexcept { return in_use_; }
  /// Set-up: puts another first one in, and gives the present one away.
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
