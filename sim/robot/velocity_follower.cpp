#include "sim/robot/velocity_follower.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace palpate::robot {
namespace {
/// Largest lead of the desired trajectory over the joints, which prevents wind-up of an arm at its
/// torque limits.
constexpr double kLead = 0.05;  // rad

/// Speed limit at a distance from a joint's end: braking uses half the acceleration limit.
double fastest(double gap, double acceleration) {
  return gap > 0 ? std::min(10 * gap, std::sqrt(acceleration * gap)) : 0.0;
}
}  // namespace

VelocityFollower::VelocityFollower(JointLimits limits, const FollowerOptions& options)
    : limits_(std::move(limits)), options_(options) {
  reset(Eigen::VectorXd::Zero(limits_.lower.size()));
}

void VelocityFollower::reset(const Eigen::VectorXd& q) {
  if (q.size() != limits_.lower.size())
    throw std::invalid_argument("the arm has " + std::to_string(limits_.lower.size()) +
                                " joints, not " + std::to_string(q.size()));
  position_ = posture_ = q;
  velocity_ = acceleration_ = joint_velocity_ = Eigen::VectorXd::Zero(q.size());
  stop();
}

void VelocityFollower::command_twist(const math::Twist& V_WE) {
  twist_ = V_WE.vector();
  mode_ = Mode::kTwist;
  age_ = 0;
}

void VelocityFollower::command_joints(const Eigen::VectorXd& joint_velocity) {
  if (joint_velocity.size() != joint_velocity_.size())
    throw std::invalid_argument("a joint velocity of the wrong size");
  joint_velocity_ = joint_velocity;
  mode_ = Mode::kJoint;
  age_ = 0;
}

void VelocityFollower::stop() {
  mode_ = Mode::kStop;
  age_ = 0;
}

Eigen::VectorXd VelocityFollower::resolved_rates(
    const Eigen::Matrix<double, 6, Eigen::Dynamic>& jacobian) const {
  // Damped only near singularities (Nakamura and Hanafusa 1986), so that elsewhere the twist is
  // followed exactly.
  math::Matrix6d squared = jacobian * jacobian.transpose();
  const Eigen::SelfAdjointEigenSolver<math::Matrix6d> eigen(squared, Eigen::EigenvaluesOnly);
  const double smallest = std::sqrt(std::max(0.0, eigen.eigenvalues()(0)));
  if (smallest < options_.singularity) {
    const double nearness = 1 - smallest / options_.singularity;
    squared.diagonal().array() += std::pow(options_.damping * nearness, 2);
  }
  const Eigen::LDLT<math::Matrix6d> factor(squared);
  const Eigen::VectorXd pull = options_.posture_gain * (posture_ - position_);
  const math::Vector6d rest = twist_ - jacobian * pull;
  return pull + jacobian.transpose() * factor.solve(rest);
}

double VelocityFollower::fastest_up(Eigen::Index i) const {
  return fastest(limits_.upper(i) - options_.limit_margin - position_(i), options_.acceleration);
}

double VelocityFollower::fastest_down(Eigen::Index i) const {
  return fastest(position_(i) - limits_.lower(i) - options_.limit_margin, options_.acceleration);
}

void VelocityFollower::limit(Eigen::VectorXd& target) const {
  // One factor for all joints keeps the direction.
  const double excess = (target.array().abs() / limits_.velocity.array()).maxCoeff();
  if (excess > 1) target /= excess;
  for (Eigen::Index i = 0; i < target.size(); ++i)
    target(i) = std::clamp(target(i), -fastest_down(i), fastest_up(i));
}

void VelocityFollower::step(double dt, const Eigen::Matrix<double, 6, Eigen::Dynamic>& jacobian,
                            const Eigen::VectorXd& q) {
  age_ += dt;
  Eigen::VectorXd target = Eigen::VectorXd::Zero(position_.size());
  if (!stale()) {
    if (mode_ == Mode::kTwist) target = resolved_rates(jacobian);
    if (mode_ == Mode::kJoint) target = joint_velocity_;
  }
  limit(target);
  const double most = options_.acceleration * dt;
  Eigen::VectorXd change = target - velocity_;
  const double excess = change.cwiseAbs().maxCoeff() / most;
  if (excess > 1) change /= excess;
  // A joint that must brake before its limit does not wait for the others.
  for (Eigen::Index i = 0; i < change.size(); ++i)
    change(i) = std::clamp(
        std::clamp(change(i), -fastest_down(i) - velocity_(i), fastest_up(i) - velocity_(i)), -most,
        most);
  acceleration_ = change / dt;
  velocity_ += change;
  position_ += velocity_ * dt;
  position_ = position_.cwiseMax(q - Eigen::VectorXd::Constant(q.size(), kLead))
                  .cwiseMin(q + Eigen::VectorXd::Constant(q.size(), kLead));
}

}  // namespace palpate::robot
