#pragma once

#include "core/math/filter.hpp"
#include "core/math/update_result.hpp"
#include "core/sensing/sensor_model.hpp"

namespace palpate::sensing {

/// Contact wrench at the wrist = reading minus the reading at zero(). Valid only while the hand
/// keeps its orientation and does not accelerate.
class FtTareOnly : public TaredModel<6, SensorState::Offset::kReading> {
 public:
  struct Options {
    int tare_samples = 500;
    bool tare_at_start = true;  // zero() at construction and after reset()
    int moving_average = 1;     // samples; 1: none (thesis software of 2018: 50 for control)
    /// samples, for alignment with a slower signal (thesis software of 2018: 6 for control)
    int delay = 0;
    double polarity = 1;             // -1 for a sensor that reports the wrench of the load on it
    double max_age = 0.025;          // s, maximum age of the latest reading
    double force_deviation = 0.1;    // N, standard deviation of each axis of the output
    double torque_deviation = 0.01;  // N m, likewise of the torque about the origin of S
    Source source = Source::kWrist0;
  };

  /// Throws std::invalid_argument naming the invalid option.
  explicit FtTareOnly(const Options& options);

  UpdateResult update(const Signals& signals, ContactSet& contacts) noexcept override;
  void reset() noexcept override;

 private:
  Options options_;
  math::DelayLine<6> delay_;
  math::MovingAverage<6> average_;
  bool has_reading_ = false;
};

}  // namespace palpate::sensing
