#pragma once

#include "core/math/update_result.hpp"
#include "core/sensing/linear_tactile.hpp"
#include "core/sensing/sensor_model.hpp"

namespace palpate::sensing {

/// Options of every sensor model of a BioTac.
struct FingertipOptions {
  int finger = 0;  // index of the BioTac, 0 to 4
  LocalizationOptions localization;
  int tare_samples = 50;          // samples at rest, at the start and after each zero()
  double contact_force = 0.15;    // N: a contact begins above it (Sanchez 2019, section 2.3)
  double release_force = 0.10;    // N: and ends below it
  double max_age = 0.05;          // s, maximum age of the latest sample
  double force_deviation = 0.03;  // N, standard deviation of each axis

  /// Throws std::invalid_argument naming the invalid option.
  void check() const;
};

/// Judges a fingertip force without an active electrode to locate it: for a single reading it is
/// noise, not a contact; a lasting one indicates a lost location.
class PlacelessForce {
 public:
  static constexpr int kMost = 10;  // consecutive readings, 0.1 s at the BioTac's 100 Hz

  void reset() noexcept { readings_ = 0; }
  /// Adds `readings` more.
  UpdateResult judge(int readings) noexcept {
    readings_ = readings_ > kMost ? readings_ : readings_ + readings;
    if (readings_ <= kMost) return {};
    return {Status::kDegraded, "a force, but no active electrode to place it"};
  }

 private:
  int readings_ = 0;
};

/// State that the sensor models of a BioTac share: tare, contact with hysteresis and its location.
class FingertipModel : public TaredModel<kTactileInputCount, SensorState::Offset::kCounts> {
 public:
  bool in_contact() const noexcept { return in_contact_; }

 protected:
  using TaredModel::TaredModel;

  /// Begins to tare, without a contact.
  void reset_contact() noexcept;
  /// Updates the hysteresis by the norm of a force, N; a contact that ends loses its location.
  void detect_contact(const FingertipOptions& options, double size) noexcept;
  /// Reports `force`, N, in T, at the present location.
  UpdateResult report(const FingertipOptions& options, const Eigen::Vector3d& force,
                      ContactSet& contacts) const noexcept;

  TactileInputs inputs_ = TactileInputs::Zero();  // tared counts of the latest sample
  bool in_contact_ = false;
  bool has_location_ = false;  // location of the present contact
  PlacelessForce placeless_;
  Eigen::Vector3d location_ = Eigen::Vector3d::Zero();
};

}  // namespace palpate::sensing
