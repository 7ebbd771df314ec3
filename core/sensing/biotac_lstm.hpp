#pragma once

#include <optional>

#include "core/math/update_result.hpp"
#include "core/sensing/electrode_scatter.hpp"
#include "core/sensing/fingertip_model.hpp"
#include "core/sensing/streamed_model.hpp"

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
class BiotacLstm : public FingertipModel {
 public:
  /// Network that predicts the outward normal of the skin at the contact.
  struct Direction {
    std::unique_ptr<Executor> executor;
    std::vector<int> inputs;  // indices into tactile_inputs(), in the network's order
    std::vector<int> outputs{0, 1, 2};
    /// Orientation in T of the frame of its outputs.
    Eigen::Matrix3d R_TN = Eigen::Matrix3d::Identity();
  };

  struct Options : FingertipOptions {
    std::vector<int> inputs;  // indices into tactile_inputs(), in the network's order
    /// Indices of the outputs that are the force on the object, in T.
    std::vector<int> outputs{0, 1, 2};
    double rate = 100;  // Hz, rate of the training samples
    ElectrodeScatter scatter = ElectrodeScatter::kNominal;
    /// N, plausible maximum: a larger prediction is scaled down, status degraded
    double largest_force = 50;
  };

  /// Throws std::invalid_argument naming the invalid option.
  BiotacLstm(const Options& options, std::unique_ptr<Executor> force,
             std::optional<Direction> direction = {});

  UpdateResult update(const Signals& signals, ContactSet& contacts) noexcept override;
  void reset() noexcept override;
  const Executor* executor(int index) const noexcept override;

  /// Network output for the latest sample, N, in T, before threshold and limit.
  Eigen::Vector3d force() const noexcept { return force_.answer(); }

 private:
  void take(const BioTac& sample) noexcept;
  bool locate() noexcept;
  UpdateResult verdict() const noexcept;

  Options options_;
  StreamedModel force_;
  std::optional<StreamedModel> direction_;
  Eigen::Matrix3d R_TN_ = Eigen::Matrix3d::Identity();
  math::Random random_;
  bool has_time_ = false;
  double time_ = 0;      // s, time of the latest sample
  double interval_ = 0;  // s, smoothed interval between samples
  bool limited_ = false;
};

}  // namespace palpate::sensing
