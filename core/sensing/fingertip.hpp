#pragma once

#include "core/math/update_result.hpp"
#include "core/sensing/sensor_model.hpp"

namespace palpate::sensing {

/// Contact of one fingertip whose sensor, of any kind, reports place, normal and force. A contact
/// is reported while the sensor does so and the force exceeds a threshold with hysteresis; it has
/// no torque about its place.
class Fingertip : public TaredModel<3, SensorState::Offset::kForce> {
 public:
  struct Options {
    int finger = 0;                     // index of the fingertip, 0 to 4
    int tare_samples = 50;              // samples without contact, after each zero()
    bool tare_at_start = false;         // zero() at construction and after reset()
    double contact_force = 0.15;        // N: a contact begins above it
    double release_force = 0.10;        // N: and ends below it; a force may pull as much
    double max_age = 0.05;              // s, maximum age of the latest sample
    double force_deviation = 0.05;      // N, of each axis, where the sensor reports none
    double max_place_deviation = 5e-3;  // m: a contact whose place is known less well is not used
  };

  /// Throws std::invalid_argument naming the invalid option.
  explicit Fingertip(const Options& options);

  UpdateResult update(const Signals& signals, ContactSet& contacts) noexcept override;
  void reset() noexcept override;
  bool in_contact() const noexcept { return in_contact_; }

 private:
  UpdateResult report(const FingertipContact& sample, const Eigen::Vector3d& force,
                      ContactSet& contacts) const noexcept;

  Options options_;
  bool in_contact_ = false;
};

}  // namespace palpate::sensing
