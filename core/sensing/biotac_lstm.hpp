#pragma once

#include <cstdint>
#include <optional>

#include "core/sensing/electrode_scatter.hpp"
#include "core/sensing/linear_tactile.hpp"
#include "core/sensing/placeless_force.hpp"
#include "core/sensing/streamed_model.hpp"
#include "core/sensing/tare.hpp"

namespace palpate::sensing {

/// Place of a touch on the skin whose outward normal is near `direction` (in T, any length above
/// zero): where the fingertip is round the normal tells it all, along its straight part `near` (m,
/// in T) tells how far up.
Eigen::Vector3d place_of_normal(const Eigen::Vector3d& direction,
                                const Eigen::Vector3d& near) noexcept;

/// Contact of one fingertip: force by a recurrent network, which takes a step for each sample of
/// tared counts (thesis 3.2); location from the electrodes, or, with a second network, from the
/// normal that it says. A contact is reported while the force is beyond a gate; it carries no
/// torque about its location.
class BiotacLstm : public SensorModel {
 public:
  /// Network of the outward normal of the skin where it is touched.
  struct Direction {
    std::unique_ptr<Executor> executor;
    std::vector<int> inputs;  // of tactile_inputs(), in the network's order
    std::vector<int> outputs{0, 1, 2};
    Eigen::Matrix3d R_TN = Eigen::Matrix3d::Identity();  // frame of its answers in T
  };

  struct Options {
    int finger = 0;                     // 0 to 4: which BioTac
    std::vector<int> inputs;            // of tactile_inputs(), in the network's order
    std::vector<int> outputs{0, 1, 2};  // places of the force on the object, in T
    double rate = 100;                  // Hz, of the samples that the network was trained on
    LocalizationOptions localization;
    ElectrodeScatter scatter = ElectrodeScatter::kNominal;
    int tare_samples = 50;          // at rest, at the start and after each zero()
    double contact_force = 0.15;    // N: a contact begins above it (thesis 2.3)
    double release_force = 0.10;    // N: and ends below it
    double largest_force = 50;      // N, that can be: beyond it the answer is shortened, degraded
    double max_age = 0.05;          // s, of the latest sample
    double force_deviation = 0.03;  // N, standard, of each axis
  };

  /// Throws std::invalid_argument naming the option that is wrong.
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
  /// The network's answer to the latest sample, N, in T, before gate and limit.
  Eigen::Vector3d force() const noexcept { return force_.answer(); }
  /// Samples passed over since construction because a number was not finite.
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
  TactileInputs inputs_ = TactileInputs::Zero();  // tared, of the latest sample
  math::Random random_;
  bool has_time_ = false;
  double time_ = 0;      // s, of the latest sample
  double interval_ = 0;  // s, smoothed, between samples
  bool in_contact_ = false;
  bool limited_ = false;
  bool has_location_ = false;  // of this contact
  PlacelessForce placeless_;
  Eigen::Vector3d location_ = Eigen::Vector3d::Zero();
  std::int64_t skipped_ = 0;
};

}  // namespace palpate::sensing
