#pragma once

#include "core/control/control_law.hpp"
#include "core/control/dead_band.hpp"
#include "core/control/pseudo_inverse.hpp"

namespace palpate::control {

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

}  // namespace palpate::control
