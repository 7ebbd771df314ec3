#pragma once

#include "core/math/rigid.hpp"

namespace palpate::object {

/// A hand that moves evenly, within a step of the plant, from where it was to where it was sent.
class HandMotion {
 public:
  explicit HandMotion(const math::Pose& X_OG = math::Pose::Identity());

  /// Pose and velocity in O at the end of the next step.
  void send(const math::Pose& X_OG, const math::Twist& V_O_G) noexcept;

  /// A step begins; then the share `s` in (0, 1] of it has passed; then it is over, and unless the
  /// hand is sent somewhere it will stand still.
  void begin() noexcept;
  void advance(double s) noexcept;
  void end() noexcept;

  /// Stops where it is.
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
