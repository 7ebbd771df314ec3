#pragma once

#include <Eigen/Core>

#include "core/math/update_result.hpp"
#include "core/sensing/input_domain.hpp"
#include "core/sensing/payload.hpp"
#include "core/sensing/recurrent_observer_inputs.hpp"
#include "core/sensing/sensor_model.hpp"
#include "core/sensing/streamed_model.hpp"

namespace palpate::sensing {

/// Rows of signals on a uniform time grid, for delayed means. Before the first row the signals are
/// assumed constant.
class SignalHistory {
 public:
  /// For means over up to `window` rows, delayed by up to `largest_delay` rows. Throws
  /// std::invalid_argument if an argument is out of range (width and window >= 1, delay >= 0, at
  /// most 1e6 rows).
  SignalHistory(int width, int window, double largest_delay);

  void clear() noexcept { count_ = 0; }
  int count() const noexcept { return count_; }  // rows since the last clear()
  /// `row`: length width.
  void push(const Eigen::Ref<const Eigen::VectorXd>& row) noexcept;
  /// Mean of the columns from `first` on, as many as `mean` has entries, over the last `window`
  /// rows, or all available ones, each delayed by `delay` rows (may be fractional). Zero without
  /// any row.
  void mean(int first, double delay, Eigen::Ref<Eigen::VectorXd> mean) const noexcept;

 private:
  Eigen::MatrixXd rows_;  // one column per row of the grid: column k % capacity is row k
  int window_;
  int count_ = 0;
};

/// Contact wrench at the wrist = reading minus load of a rigid payload minus a recurrent network's
/// prediction of the residual (Sanchez 2019, section 3.4, there without a payload). All streams are
/// delayed to the latest of them and averaged over the same window; the network steps once every
/// fixed number of ticks, and the contact is held in between. Times are arrival times on the grid
/// of the loop.
class FtRnnob : public TaredModel<6, SensorState::Offset::kWithoutPayload> {
 public:
  struct Options {
    /// Indices into observer_inputs() of the network's inputs, in its order.
    std::vector<int> inputs;
    /// Indices of force and torque (x, y, z each) among the network's outputs.
    std::vector<int> outputs{0, 1, 2, 3, 4, 5};
    double rate = 100;   // Hz, rate of the network's steps; the loop's rate is a multiple of it
    double average = 0;  // s, trailing average of all streams; 0: none
    /// s, delay of a stream relative to the robot's pose; negative: it leads.
    double inertial_delay = 0;
    double force_torque_delay = 0;
    /// False: the network's outputs contain the complete non-contact wrench, and `payload` is used
    /// for the fallback only.
    bool network_gives_rest = true;
    PayloadParameters payload;
    /// Domain of the network's inputs: outside it the network's part fades to zero and only the
    /// payload is compensated. Used only if the network predicts the residual.
    InputDomain domain;
    /// Continues with the payload only, degraded, if the network fails. False: a failure is a
    /// fault.
    bool fall_back = false;

    double period = 1e-3;                      // s, period of the loop
    Eigen::Vector3d gravity_W{0, 0, -9.81};    // m/s^2
    math::Pose X_ES = math::Pose::Identity();  // pose of the force-torque sensor in the flange
    math::Pose X_EI = math::Pose::Identity();  // pose of the IMU in the flange
    int tare_samples = 50;                     // number of network steps
    bool tare_at_start = false;
    double polarity = 1;             // -1 for a sensor that reports the wrench of the load on it
    double max_age = 0.025;          // s, maximum age of every stream
    double force_deviation = 0.1;    // N, standard deviation of each axis of the output
    double torque_deviation = 0.01;  // N m, likewise of the torque about the origin of S
    Source source = Source::kWrist0;
  };

  /// Throws std::invalid_argument naming the invalid option.
  FtRnnob(const Options& options, std::unique_ptr<Executor> executor);

  UpdateResult update(const Signals& signals, ContactSet& contacts) noexcept override;
  void reset() noexcept override;
  const Executor* executor(int index) const noexcept override {
    return index == 0 ? &network_.executor() : nullptr;
  }

 private:
  static constexpr int kWidth = 22;  // columns of the history
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
  double pose_delay_, inertial_delay_, wrench_delay_;  // ticks, relative to the latest stream
  Eigen::VectorXd input_;                              // network inputs, as passed to the domain
  StreamedModel network_;
  SignalHistory history_;

  Row row_ = Row::Zero();  // row of this tick
  /// a finite value was received since the last restart
  bool has_inertial_ = false;
  bool has_wrench_ = false;  // likewise
  /// Orientation at the previous step; zero: none.
  Eigen::Vector4d previous_xyzw_ = Eigen::Vector4d::Zero();
  Eigen::Vector3d previous_rate_S_ = Eigen::Vector3d::Zero();
  bool has_rest_ = false;
  math::Vector6d rest_ = math::Vector6d::Zero();  // result of the last step
};

}  // namespace palpate::sensing
