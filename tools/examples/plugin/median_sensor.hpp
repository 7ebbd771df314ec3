#pragma once

#include <array>

#include "rt/plugin/plugin.hpp"

namespace example {

/// Example of a user's sensor model for a wrist whose readings have spikes: the median of the last
/// samples of each axis, minus the reading at zero(). Like ft_tare_only it is valid only while the
/// hand keeps its orientation.
class MedianSensor : public palpate::plugin::PluginSensorModel {
 public:
  static constexpr int kMostSamples = 63;
  struct Options {
    int samples = 5;  // odd
    int tare_samples = 500;
    double max_age = 0.025;        // s
    double force_deviation = 0.1;  // N, standard, of each axis
  };
  static palpate::config::OptionTable<Options> table();

  /// Throws std::invalid_argument for an even number of samples.
  explicit MedianSensor(const Options& options);

  palpate::UpdateResult update(const palpate::sensing::Signals& signals,
                               palpate::sensing::ContactSet& contacts) override;
  void zero() override { tare_.start(); }
  void reset() override;
  // Allows the transfer of the wrist's state to and from another model while the loop runs.
  palpate::sensing::SensorState save() const override {
    return palpate::sensing::save(tare_, palpate::sensing::SensorState::Offset::kReading);
  }
  bool restore(const palpate::sensing::SensorState& state) override {
    return palpate::sensing::restore(state, palpate::sensing::SensorState::Offset::kReading, tare_);
  }

 private:
  palpate::math::Vector6d median() const;

  Options options_;
  palpate::math::Tare<6> tare_;
  std::array<palpate::math::Vector6d, kMostSamples> last_{};
  int count_ = 0, next_ = 0;
};

}  // namespace example
