#pragma once

#include "core/math/rigid.hpp"

namespace palpate::object {

/// Motion of a hand at constant velocity within a step of the plant, from its last pose to the
/// commanded one.
class HandMotion {
 public:
  explicit HandMotion(const math::Pose& X_OG = math::Pose::Identity());

  /// Pose and velocity in O at the end of the next step.
  void send(const math::Pose& X_OG, const math::Twist& V_O_G) noexcept;

  /// Begins a step; advances to the fraction `s` in (0, 1] of it; ends it. Without a further
  /// command the hand then stands still.
  void begin() noexcept;
  void advance(double s) noexcept;
  void end() noexcept;

  /// Stops at the current pose.
  void stop() noexcept;

  const math::Pose& X_OG() const { return X_OG_; }
  const math::Twist& V_O_G() const { return V_O_G_; }

 private:
  math::Pose X_OG_;
  math::Twist V_O_G_;
  math::Pose X_start_;
  math::Twist V_start_;
  Eigen::Quaterniond q_start_ = Eigen::Quaterniond::Identity();
  math::Pose X_end_;
  math::Twist V_end_;
  Eigen::Quaterniond q_end_ = Eigen::Quaterniond::Identity();
};

}  // namespace palpate::object
