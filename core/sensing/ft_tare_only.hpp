#pragma once

#include <cstdint>

#include "core/math/filter.hpp"
#include "core/sensing/sensor_model.hpp"
#include "core/sensing/tare.hpp"

namespace palpate::sensing {

/// Contact wrench at the wrist = reading minus what was read at zero(). Right only while the hand
/// keeps its orientation and does not accelerate.
class FtTareOnly : public SensorModel {
 public:
  struct Options {
    int tare_samples = 500;
    bool tare_at_start = true;     // zero() at construction and after reset()
    int moving_average = 1;        // samples; 1: none (2018: 50 for control)
    int delay = 0;                 // samples, to align with a slower signal (2018: 6 for control)
    double polarity = 1;           // -1 for a sensor that reports what the load exerts on it
    double max_age = 0.025;        // s, of the latest reading
    double force_deviation = 0.1;  // N, standard, of each axis of the output
    Source source = Source::kWrist0;
  };

  /// Throws std::invalid_argument naming the option that is wrong.
  explicit FtTareOnly(const Options& options);

  UpdateResult update(const Signals& signals, ContactSet& contacts) noexcept override;
  void zero() noexcept override { tare_.start(); }
  void reset() noexcept override;
  SensorState save() const noexcept override {
    return sensing::save(tare_, SensorState::Offset::kReading);
  }
  bool restore(const SensorState& state) noexcept override {
    return sensing::restore(state, SensorState::Offset::kReading, tare_);
  }

  /// Readings passed over since construction because a number was not finite.
  std::int64_t skipped() const noexcept { return skipped_; }

 private:
  Options options_;
  Tare<6> tare_;
  math::DelayLine<6> delay_;
  math::MovingAverage<6> average_;
  bool has_reading_ = false;
  std::int64_t skipped_ = 0;
};

}  // namespace palpate::sensing
