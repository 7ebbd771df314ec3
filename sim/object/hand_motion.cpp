#include "sim/object/hand_motion.hpp"

namespace palpate::object {

HandMotion::HandMotion(const math::Pose& X_OG) : X_OG_(X_OG), X_start_(X_OG), X_end_(X_OG) {}

void HandMotion::send(const math::Pose& X_OG, const math::Twist& V_O_G) noexcept {
  X_end_ = X_OG;
  V_end_ = V_O_G;
}

void HandMotion::begin() noexcept {
  X_start_ = X_OG_;
  V_start_ = V_O_G_;
  q_start_ = Eigen::Quaterniond(X_start_.linear());
  q_end_ = Eigen::Quaterniond(X_end_.linear());
}

void HandMotion::advance(double s) noexcept {
  X_OG_.translation() = (1 - s) * X_start_.translation() + s * X_end_.translation();
  X_OG_.linear() = q_start_.slerp(s, q_end_).toRotationMatrix();
  V_O_G_.linear = (1 - s) * V_start_.linear + s * V_end_.linear;
  V_O_G_.angular = (1 - s) * V_start_.angular + s * V_end_.angular;
}

void HandMotion::end() noexcept { V_end_ = math::Twist(); }

void HandMotion::stop() noexcept {
  X_end_ = X_OG_;
  V_O_G_ = V_end_ = math::Twist();
}

}  // namespace palpate::object
