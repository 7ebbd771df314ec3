#pragma once

#include <cstdint>
#include <optional>

#include "core/sensing/electrode_scatter.hpp"
#include "core/sensing/linear_tactile.hpp"
#include "core/sensing/placeless_force.hpp"
#include "core/sensing/streamed_model.hpp"
#include "core/sensing/tare.hpp"

namespace palpate::sensing {

/// Location on the skin whose outward normal is nearest to `direction` (in T, any positive length).
/// On the spherical part the normal determines it; on the cylindrical part `near` (m, in T)
/// determines the axial coordinate.
Eigen::Vector3d place_of_normal(const Eigen::Vector3d& direction,
                                const Eigen::Vector3d& near) noexcept;

/// Contact of one fingertip: force by a recurrent network, one step per sample of tared counts
/// (Sanchez 2019, section 3.2); location from the electrodes or, with a second network, from the
/// predicted surface normal. A contact is reported while the force exceeds a threshold with
/// hysteresis; it has no torque about its location.
class BiotacLstm : public SensorModel {
 public:
  /// Network that predicts the outward normal of the skin at the contact.
  struct Direction {
    std::unique_ptr<Executor> executor;
    std::vector<int> inputs;  // indices into tactile_inputs(), in the network's order
    std::vector<int> outputs{0, 1, 2};
    /// Orientation in T of the frame of its outputs.
    Eigen::Matrix3d R_TN = Eigen::Matrix3d::Identity();
  };

  struct Options {
    int finger = 0;           // index of the BioTac, 0 to 4
    std::vector<int> inputs;  // indices into tactile_inputs(), in the network's order
    /// Indices of the outputs that are the force on the object, in T.
    std::vector<int> outputs{0, 1, 2};
    double rate = 100;  // Hz, rate of the training samples
    LocalizationOptions localization;
    ElectrodeScatter scatter = ElectrodeScatter::kNominal;
    int tare_samples = 50;        // samples at rest, at the start and after each zero()
    double contact_force = 0.15;  // N: a contact begins above it (Sanchez 2019, section 2.3)
    double release_force = 0.10;  // N: and ends below it
    /// N, plausible maximum: a larger prediction is scaled down, status degraded
    double largest_force = 50;
    double max_age = 0.05;          // s, maximum age of the latest sample
    double force_deviation = 0.03;  // N, standard deviation of each axis
  };

  /// Throws std::invalid_argument naming the invalid option.
  BiotacLstm(const Options& options, std::unique_ptr<Executor> force,
             std::optional<Direction> direction = {});

  UpdateResult update(const Signals& signals, ContactSet& contacts) noexcept override;
  void zero() noexcept override { tare_.start(); }
  void reset() noexcept override;
  SensorState save() const noexcept override {
    return sensing::save(tare_, SensorState::Offset::kCounts);
  }
  bool restore(const SensorState& state) noexcept override {
    return sensing::restore(state, SensorState::Offset::kCounts, tare_);
  }
  const Executor* executor(int index) const noexcept override;

  bool in_contact() const noexcept { return in_contact_; }
  /// Network output for the latest sample, N, in T, before threshold and limit.
  Eigen::Vector3d force() const noexcept { return force_.answer(); }
  /// Samples rejected since construction because a number was not finite.
  std::int64_t skipped() const noexcept { return skipped_; }

 private:
  void take(const BioTac& sample) noexcept;
  bool locate() noexcept;
  UpdateResult verdict() const noexcept;

  Options options_;
  StreamedModel force_;
  std::optional<StreamedModel> direction_;
  Eigen::Matrix3d R_TN_ = Eigen::Matrix3d::Identity();
  Tare<kTactileInputCount> tare_;
  TactileInputs inputs_ = TactileInputs::Zero();  // tared counts of the latest sample
  math::Random random_;
  bool has_time_ = false;
  double time_ = 0;      // s, time of the latest sample
  double interval_ = 0;  // s, smoothed interval between samples
  bool in_contact_ = false;
  bool limited_ = false;
  bool has_location_ = false;  // location of the present contact
  PlacelessForce placeless_;
  Eigen::Vector3d location_ = Eigen::Vector3d::Zero();
  std::int64_t skipped_ = 0;
};

}  // namespace palpate::sensing
