#pragma once

#include "core/control/control_law.hpp"
#include "core/control/pseudo_inverse.hpp"

namespace palpate::control {

/// Stop band with hysteresis: at rest from when both errors are inside the band until one of them
/// leaves a larger band.
class DeadBand {
 public:
  struct Options {
    double position = 1e-3;  // m
    double angle = 3.5e-3;   // rad
    double release = 1.2;    // >= 1, motion resumes outside this multiple of the band
  };

  explicit DeadBand(const Options& options) : options_(options) {}

  bool rests(double position_error, double angle_error) noexcept {
    const double factor = resting_ ? options_.release : 1.0;
    resting_ =
        position_error <= factor * options_.position && angle_error <= factor * options_.angle;
    return resting_;
  }

  void reset() noexcept { resting_ = false; }

 private:
  Options options_;
  bool resting_ = false;
};

struct TwistLawOptions {
  double gain = 1.0;           // 1/s, > 0
  double linear_speed = 1.0;   // m/s, > 0, maximum speed of the origin of G
  double angular_speed = 0.5;  // rad/s, > 0
  DeadBand::Options dead_band;
  PseudoInverse::Options inverse;

  /// Gain, saturation and dead band of Sanchez 2019: 0.25 1/s, 1 m/s, 0.5 rad/s, 5 mm, 1 degree.
  static TwistLawOptions thesis() noexcept;
};

/// Law of the form u = J^+ (gain * motion): the derived class defines the motion that brings the
/// feature to its target. Stops inside the dead band of the reachable error (for a set of points,
/// the root mean square over the points); scales the twist to the speed limits.
class TwistLaw : public ControlLaw {
 public:
  using Options = TwistLawOptions;

  /// Throws std::invalid_argument if an option is out of range.
  explicit TwistLaw(const Options& options);

  void configure_for(const shape::Feature& feature) override;
  /// The twist is zero if an input is not finite or nothing is reachable.
  void compute(const LawInputs& inputs, LawOutput& output) noexcept final;
  void reset() noexcept override { dead_band_.reset(); }

 protected:
  /// Small motion of the feature towards its target, in the coordinates of its error.
  virtual void motion_to_target(const LawInputs& inputs, Eigen::VectorXd& motion) noexcept = 0;

  /// Twists by which the feature moves with `motion`, its units per second: J^+ motion. A law with
  /// limits returns the best approximation within them.
  virtual PseudoInverse::Motion solve(const LawInputs& inputs, const Eigen::VectorXd& motion,
                                      LawOutput& output) noexcept;
  /// Called instead of solve() if no motion is required.
  virtual void rest() noexcept {}

  const Options& options() const noexcept { return options_; }
  const PseudoInverse& inverse() const noexcept { return inverse_; }

 private:
  bool rests(const Eigen::VectorXd& reachable) noexcept;

  Options options_;
  PseudoInverse inverse_;
  DeadBand dead_band_;
  Eigen::VectorXd position_rows_;  // weight of each row in the position of the dead band, m
  Eigen::VectorXd angle_rows_;     // the same for the angle
  double point_scale_ = 1;         // 1 / sqrt(number of points in the error)
  Eigen::VectorXd motion_;
};

/// Proportional law u = J^+ (gain * error). Supports every feature; with an exact J each component
/// of the error decays as exp(-gain t).
class ProportionalTwist : public TwistLaw {
 public:
  explicit ProportionalTwist(const Options& options) : TwistLaw(options) {}

 protected:
  void motion_to_target(const LawInputs& inputs, Eigen::VectorXd& motion) noexcept override {
    motion = *inputs.error;
  }
};

/// Pose control with dual quaternions (Ozgur and Mezouar 2016). The feature's twist is -gain times
/// the screw of x_c (x) x_d*, so that it approaches its target along one screw while angle and
/// distance decay as exp(-gain t). Supports pose features.
class DualQuaternion : public TwistLaw {
 public:
  explicit DualQuaternion(const Options& options) : TwistLaw(options) {}

  void configure_for(const shape::Feature& feature) override;

 protected:
  void motion_to_target(const LawInputs& inputs, Eigen::VectorXd& motion) noexcept override;
};

}  // namespace palpate::control
