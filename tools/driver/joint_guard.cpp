#include "joint_guard.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/math/axis_motion.hpp"

namespace palpate::driver {
namespace {

constexpr double kDamper = 5;  // 1/s: the speed towards a limit is at most this times the distance,
constexpr double kBraking =
    0.9;  // nor so high that braking would take more than this fraction of it

Eigen::Vector3d limited(const Eigen::Vector3d& velocity, double limit) {
  const double speed = velocity.stableNorm();
  return speed > limit ? Eigen::Vector3d(limit / speed * velocity) : velocity;
}

}  // namespace

JointGuard::JointGuard(const kinematics::SerialChain& chain, const Options& options)
    : chain_(chain), options_(options) {
  wanted_.setZero(chain.joint_count());
  sent_.setZero(chain.joint_count());
  gained_.setZero(chain.joint_count());
}

void JointGuard::follow(const math::Twist& V_W_E, const Joints& q) {
  chain_.evaluate(q, state_);
  math::Vector6d twist;
  twist << limited(V_W_E.linear, options_.linear_speed),
      limited(V_W_E.angular, options_.angular_speed);
  math::Matrix6d A = state_.J_W_E * state_.J_W_E.transpose();
  A.diagonal().array() += options_.damping * options_.damping;
  wanted_.noalias() = state_.J_W_E.transpose() * A.ldlt().solve(twist);
}

/// Every joint slows down by the same factor as the one near its limit.
void JointGuard::slow_down_near_ends(const Joints& q) {
  double share = 1;
  for (int i = 0; i < wanted_.size(); ++i) {
    const kinematics::Joint& joint = chain_.joint(i);
    const double left = wanted_[i] > 0 ? joint.upper - options_.margin - q[i]
                                       : q[i] - joint.lower - options_.margin;
    const double fastest = options_.speed_share * joint.speed;
    const double damper = std::min(kDamper, kBraking * options_.acceleration / fastest);
    const double most = std::min(fastest, damper * std::max(0.0, left));
    const double speed = std::abs(wanted_[i]);
    if (speed > most) share = std::min(share, most / speed);
  }
  wanted_ *= share;
}

/// Towards wanted_, with the jerk limit.
void JointGuard::change_smoothly() {
  const math::AxisLimits limits{options_.acceleration, options_.jerk};
  const double dt = options_.period, step = options_.acceleration * dt;
  for (int i = 0; i < wanted_.size(); ++i) {
    const double v = sent_[i], way = wanted_[i] - v;
    if (std::abs(wanted_[i]) > std::abs(v) && v * wanted_[i] >= 0) {
      const double a = math::acceleration_towards(way, gained_[i], limits, dt);
      // a command that has fallen takes effect at once
      gained_[i] = std::abs(a * dt) > std::abs(way) ? way / dt : a;
      sent_[i] += gained_[i] * dt;
    } else {
      const double back = v * wanted_[i] < 0 ? -v : way;  // rests before it turns round
      sent_[i] += std::clamp(back, -step, step);
      gained_[i] = 0;
    }
  }
}

const Joints& JointGuard::limit(const Command& command, const Joints& q) {
  switch (command.kind) {
    case Command::Kind::kStop:
      wanted_.setZero();
      break;
    case Command::Kind::kTwist:
      follow(command.V_W_E, q);
      break;
    case Command::Kind::kJoints:
      wanted_ = command.dq;
      break;
  }
  slow_down_near_ends(q);
  if (options_.jerk > 0) {
    change_smoothly();
    return sent_;
  }
  const double step = options_.acceleration * options_.period;
  // Individually: a joint that brakes before its limit must not wait for the others.
  sent_ += (wanted_ - sent_).cwiseMax(-step).cwiseMin(step);
  return sent_;
}

}  // namespace palpate::driver
