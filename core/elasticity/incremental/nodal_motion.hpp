#pragma once

#include "core/elasticity/incremental/numbered_body.hpp"

namespace palpate::elasticity {

/// Positions and velocities of the nodes, in the solver's numbering and as published in mesh order,
/// at the beginning of a step and now, and how far off the last steps' predictions were. Velocities
/// are zero if quasi-static.
class NodalMotion {
 public:
  /// `body` must outlive this object.
  NodalMotion(const NumberedBody& body, bool dynamic);

  /// m, m/s; x_begin(): positions at the beginning of the step.
  NodalField& x() noexcept { return x_; }
  const NodalField& x() const noexcept { return x_; }
  const NodalField& v() const noexcept { return v_; }
  const NodalField& x_begin() const noexcept { return x_begin_; }

  void begin_step() noexcept { x_begin_ = x_; }
  /// Declares x() to be the prediction of the step from what is known, and adds to it, if
  /// `improve`, the part of the last prediction's error that is expected to recur.
  void complete_prediction(bool improve) noexcept;
  /// Sets velocities from the positions reached after `dt` s and measures the prediction's error.
  void finish_step(double dt) noexcept;
  /// Returns to the beginning of the step.
  void undo_step() noexcept { x_ = x_begin_; }
  /// Makes x() the beginning of the step, at rest.
  void stop() noexcept;
  /// To be called when predictions are made in another way: their last error will not recur.
  void forget_persistence() noexcept { persistence_ = 0; }

  /// As published last, 3 x n in mesh order.
  const Eigen::Matrix3Xd& positions() const noexcept { return positions_; }
  const Eigen::Matrix3Xd& velocities() const noexcept { return velocities_; }
  void publish() noexcept;

  /// Sets and publishes the rest shape, or the given state except for fixed nodes. The latter is
  /// rejected (false) if sizes differ or a number is not finite.
  void reset() noexcept;
  bool restore(const Eigen::Matrix3Xd& positions, const Eigen::Matrix3Xd& velocities) noexcept;

 private:
  const NumberedBody& body_;
  bool dynamic_;
  NodalField x_, v_, x_begin_;
  NodalField x_expected_, prediction_error_;
  /// Fraction of a step's prediction error that recurs in the next one, 0 to 1.
  double persistence_ = 0;
  Eigen::Matrix3Xd positions_, velocities_;  // in mesh order
};

}  // namespace palpate::elasticity
