#pragma once

#include <cstdint>

#include "core/sensing/linear_tactile.hpp"
#include "core/sensing/placeless_force.hpp"
#include "core/sensing/tare.hpp"

namespace palpate::sensing {

/// Contact of one fingertip: force by a linear map of its counts; location from its electrodes, or
/// by the map if it includes one. A contact is reported while the force exceeds a threshold with
/// hysteresis; it has no torque about its location.
class BiotacLinear : public SensorModel {
 public:
  struct Options {
    int finger = 0;            // index of the BioTac, 0 to 4
    LinearTactileModel model;  // predicts the force on the object, in T
    LocalizationOptions localization;
    int tare_samples = 50;          // samples at rest, at the start and after each zero()
    double contact_force = 0.15;    // N: a contact begins above it (Sanchez 2019, section 2.3)
    double release_force = 0.10;    // N: and ends below it
    double max_age = 0.05;          // s, maximum age of the latest sample
    double force_deviation = 0.03;  // N, standard deviation of each axis
  };

  /// Throws std::invalid_argument naming the invalid option.
  explicit BiotacLinear(const Options& options);

  UpdateResult update(const Signals& signals, ContactSet& contacts) noexcept override;
  void zero() noexcept override { tare_.start(); }
  void reset() noexcept override;
  SensorState save() const noexcept override {
    return sensing::save(tare_, SensorState::Offset::kCounts);
  }
  bool restore(const SensorState& state) noexcept override {
    return sensing::restore(state, SensorState::Offset::kCounts, tare_);
  }

  bool in_contact() const noexcept { return in_contact_; }
  /// Samples rejected since construction because a number was not finite.
  std::int64_t skipped() const noexcept { return skipped_; }

 private:
  Options options_;
  Tare<kTactileInputCount> tare_;
  TactileInputs inputs_ = TactileInputs::Zero();  // tared counts of the latest sample
  bool has_inputs_ = false;
  bool in_contact_ = false;
  bool has_location_ = false;  // location of the present contact
  PlacelessForce placeless_;
  Eigen::Vector3d location_ = Eigen::Vector3d::Zero();
  std::int64_t skipped_ = 0;
};

}  // namespace palpate::sensing
