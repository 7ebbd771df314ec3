#pragma once

#include "core/control/control_law.hpp"
#include "core/control/dead_band.hpp"
#include "core/control/pseudo_inverse.hpp"

namespace palpate::control {

struct TwistLawOptions {
  double gain = 1.0;           // 1/s, > 0
  double linear_speed = 1.0;   // m/s, > 0, largest of the origin of G
  double angular_speed = 0.5;  // rad/s, > 0
  DeadBand::Options dead_band;
  PseudoInverse::Options inverse;

  /// Gain, saturation and dead band of Sanchez 2019: 0.25 1/s, 1 m/s, 0.5 rad/s, 5 mm, 1 degree.
  static TwistLawOptions thesis() noexcept;
};

/// A law of the form u = J^+ (gain * motion): the derived law says by which motion the feature
/// would come to its target. Rests in the dead band of the reachable error, of a set of points its
/// root mean square over the points; scales to the speed limits.
class TwistLaw : public ControlLaw {
 public:
  using Options = TwistLawOptions;

  /// Throws std::invalid_argument where an option is out of range.
  explicit TwistLaw(const Options& options);

  void configure_for(const shape::Feature& feature) override;
  /// Twist is zero where an input is not finite or nothing can be reached.
  void compute(const LawInputs& inputs, LawOutput& output) noexcept final;
  void reset() noexcept override { dead_band_.reset(); }

 protected:
  /// Small motion of the feature that would bring it to its target, in the coordinates of its
  /// error.
  virtual void motion_to_target(const LawInputs& inputs, Eigen::VectorXd& motion) noexcept = 0;

  /// The twists by which the feature moves as `motion` says, 1/s of its units: J^+ motion. A law
  /// that keeps limits does what it can within them.
  virtual PseudoInverse::Motion solve(const LawInputs& inputs, const Eigen::VectorXd& motion,
                                      LawOutput& output) noexcept;
  /// Called in place of solve() where nothing is to be moved.
  virtual void rest() noexcept {}

  const Options& options() const noexcept { return options_; }
  const PseudoInverse& inverse() const noexcept { return inverse_; }

 private:
  bool rests(const Eigen::VectorXd& reachable) noexcept;

  Options options_;
  PseudoInverse inverse_;
  DeadBand dead_band_;
  Eigen::VectorXd position_rows_;  // what a row counts in the dead band's position, m
  Eigen::VectorXd angle_rows_;     // the same for its angle
  double point_scale_ = 1;         // 1 / sqrt(number of points that the error speaks of)
  Eigen::VectorXd motion_;
};

}  // namespace palpate::control
