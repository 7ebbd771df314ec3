#pragma once

#include <memory>

#include "core/sensing/sensor_model.hpp"

namespace palpate::component {

/// A sensor model with another one of the same sensor to fall back on. Both see all signals, so
/// that the second is tared and warm when it is wanted; only one of them reports contacts. Where
/// the first faults the second goes on, degraded, until reset().
class SensorFallback final : public sensing::SensorModel {
 public:
  /// `reason`, a string literal: what to say while the fallback runs.
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
  const sensing::Executor* executor(int index) const noexcept override {
    return first_->executor(index);
  }

 private:
  std::unique_ptr<sensing::SensorModel> first_, second_;
  const char* reason_;
  sensing::ContactSet unused_;
};

}  // namespace palpate::component
