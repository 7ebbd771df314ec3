#pragma once

#include <cstdint>

#include "core/sensing/input_domain.hpp"
#include "core/sensing/payload.hpp"
#include "core/sensing/recurrent_observer_inputs.hpp"
#include "core/sensing/sensor_model.hpp"
#include "core/sensing/signal_history.hpp"
#include "core/sensing/streamed_model.hpp"
#include "core/sensing/tare.hpp"

namespace palpate::sensing {

/// Contact wrench at the wrist = reading minus what a rigid payload explains minus what a recurrent
/// network says of the rest (thesis 3.4, there without a payload). All streams are delayed to the
/// latest of them and averaged alike; the network takes a step every so many ticks, between which
/// the contact stands. Times are those of arrival, on the loop's own grid.
class FtRnnob : public SensorModel {
 public:
  struct Options {
    /// Of observer_inputs(), those that the network takes, in its order.
    std::vector<int> inputs;
    /// Places of force and torque (x, y, z each) among the network's outputs.
    std::vector<int> outputs{0, 1, 2, 3, 4, 5};
    double rate = 100;   // Hz, of the network's steps; the loop's rate is a multiple of it
    double average = 0;  // s, trailing mean of all streams; 0: none
    /// s, by which a stream lags behind the robot's pose; below 0: it leads.
    double inertial_delay = 0;
    double force_torque_delay = 0;
    /// False: the network's outputs are all that is no contact, and `payload` serves the fallback.
    bool network_gives_rest = true;
    PayloadParameters payload;
    /// Of the network's inputs: away from it the network's part fades, and the payload alone is
    /// left. Only where the network gives the rest.
    InputDomain domain;
    /// Goes on with the payload alone, degraded, where the network fails. False: that is a fault.
    bool fall_back = false;

    double period = 1e-3;                      // s, of the loop
    Eigen::Vector3d gravity_W{0, 0, -9.81};    // m/s^2
    math::Pose X_ES = math::Pose::Identity();  // force-torque sensor in the flange
    math::Pose X_EI = math::Pose::Identity();  // inertial unit in the flange
    int tare_samples = 50;                     // steps
    bool tare_at_start = false;
    double polarity = 1;           // -1 for a sensor that reports what the load exerts on it
    double max_age = 0.025;        // s, of every stream
    double force_deviation = 0.1;  // N, standard, of each axis of the output
    Source source = Source::kWrist0;
  };

  /// Throws std::invalid_argument naming the option that is wrong.
  FtRnnob(const Options& options, std::unique_ptr<Executor> executor);

  UpdateResult update(const Signals& signals, ContactSet& contacts) noexcept override;
  void zero() noexcept override { tare_.start(); }
  void reset() noexcept override;
  SensorState save() const noexcept override {
    return sensing::save(tare_, SensorState::Offset::kBesidePayload);
  }
  bool restore(const SensorState& state) noexcept override {
    return sensing::restore(state, SensorState::Offset::kBesidePayload, tare_);
  }
  const Executor* executor(int index) const noexcept override {
    return index == 0 ? &network_.executor() : nullptr;
  }

  /// Samples passed over since construction because a number was not finite.
  std::int64_t skipped() const noexcept { return skipped_; }

 private:
  static constexpr int kWidth = 22;  // numbers in a row of the history
  using Row = Eigen::Matrix<double, kWidth, 1>;

  const char* missing(const Signals& signals) const noexcept;
  void restart() noexcept;
  void take(const Signals& signals) noexcept;
  void step() noexcept;
  LoadMotion mean_motion(const Eigen::Matrix<double, 6, 1>& inertial) noexcept;

  Options options_;
  Eigen::Matrix3d R_SI_;
  Eigen::Vector3d p_SI_;  // origin of I in S
  int ticks_per_step_;
  double pose_delay_, inertial_delay_, wrench_delay_;  // ticks, behind the latest stream
  Eigen::VectorXd input_;                              // of the network, as the domain has them
  StreamedModel network_;
  SignalHistory history_;
  Tare<6> tare_;

  Row row_ = Row::Zero();                                    // the present one
  bool has_inertial_ = false;                                // a finite one, since the last restart
  bool has_wrench_ = false;                                  // likewise
  Eigen::Vector4d previous_xyzw_ = Eigen::Vector4d::Zero();  // of the step before; zero: none
  Eigen::Vector3d previous_rate_S_ = Eigen::Vector3d::Zero();
  bool has_rest_ = false;
  math::Vector6d rest_ = math::Vector6d::Zero();  // of the last step
  std::int64_t skipped_ = 0;
};

}  // namespace palpate::sensing
