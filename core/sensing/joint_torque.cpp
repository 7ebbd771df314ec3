#include "core/sensing/joint_torque.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "core/math/constants.hpp"
#include "core/math/option_check.hpp"

namespace palpate::sensing {
namespace {

/// Of a wrench before any reading: beyond what a hand that handles soft objects exerts.
constexpr double kPriorForce = 100, kPriorTorque = 20;  // N, N m

}  // namespace

JointTorque::JointTorque(const kinematics::ChainDynamics& dynamics, const Options& options)
    : TaredModel(options.tare_samples),
      dynamics_(dynamics),
      options_(options),
      friction_(options.friction) {
  const int n = dynamics_.chain().joint_count();
  math::check_polarity(options.polarity);
  math::check_positive(options.bandwidth, "bandwidth");
  math::check_positive(options.max_age, "max_age");
  math::check_not_negative(options.model_error, "model_error");
  const std::string wanted = "one value per joint, " + std::to_string(n);
  math::check_option(options.friction.coulomb.size() == n, "coulomb",
                     options.friction.coulomb.size(), wanted);
  math::check_option(options.deviation.size() == n, "deviation", options.deviation.size(), wanted);
  for (int i = 0; i < n; ++i) math::check_positive_finite(options.deviation[i], "deviation");
  for (Joints* joints :
       {&q_, &driving_, &driving_before_, &residual_, &external_, &deviation_, &tared_load_})
    joints->setZero(n);
  reset();
}

void JointTorque::reset() noexcept {
  tare_.reset();
  if (options_.tare_at_start) tare_.start();
  friction_.reset();
  has_reading_ = false;
  unusable_ = Reading::kUsable;
  unusable_for_ = 0;
  residual_.setZero();
  external_.setZero();
  tared_load_.setZero();
}

JointTorque::Reading JointTorque::read(const RobotState& state) const noexcept {
  const int n = dynamics_.chain().joint_count();
  if (state.joint_count != n) return Reading::kWrongCount;
  if (!state.q.head(n).allFinite() || !state.dq.head(n).allFinite() ||
      !state.tau.head(n).allFinite() || !std::isfinite(state.time))
    return Reading::kNotFinite;
  return (state.tau.head(n).array() == 0).all() ? Reading::kAbsent : Reading::kUsable;
}

void JointTorque::take(const RobotState& state) noexcept {
  constexpr double kLongestGap = 0.1;  // s; beyond it the observer starts with what it has found
  const int n = dynamics_.chain().joint_count();
  const double step = state.time - time_;
  const bool follows = has_reading_ && step > 0 && step < kLongestGap;
  time_ = state.time;
  has_reading_ = true;
  q_ = state.q.head(n);
  const Joints dq = state.dq.head(n), tau = options_.polarity * state.tau.head(n);
  const double gain = 2 * math::kPi * options_.bandwidth;
  if (!follows) friction_.reset();
  friction_.follow(q_, dq);
  Joints load = Joints::Zero(n);
  if (options_.external) {
    const double share = follows ? gain * step / (1 + gain * step) : 1.0;
    residual_ += share * (tau - residual_);
    deviation_ = options_.deviation;
  } else {
    dynamics_.evaluate(q_, dq, state_);
    load = state_.gravity - state_.coriolis;
    driving_ = tau - friction_.torque() - load;
    // implicit in the residual, and the mean of two readings for the driving torque
    if (follows)
      residual_ = (residual_ + gain * (state_.momentum - before_.momentum -
                                       0.5 * step * (driving_ + driving_before_))) /
                  (1 + gain * step);
    before_ = state_;
    driving_before_ = driving_;
    deviation_ = (options_.deviation.array().square() + friction_.deviation().array().square() +
                  (options_.model_error * (load - tared_load_)).array().square())
                     .sqrt();
  }
  if (tare_.is_running() && (options_.external || friction_.is_known())) {
    Eigen::Matrix<double, 16, 1> sample = Eigen::Matrix<double, 16, 1>::Zero();
    sample.head(n) = residual_;
    tare_.update(sample);
    if (!tare_.is_running()) tared_load_ = load;
  }
  external_ = residual_ - tare_.offset().head(n);
}

/// The wrench F on the hand minimises |(tau_ext - J^T F) / deviation|^2 + |F / prior|^2; the
/// inverse of the quadratic form is its covariance. The contact is the opposite of F.
Contact JointTorque::contact() const noexcept {
  using Rows = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kinematics::SerialChain::kMostJoints>;
  const Eigen::Matrix3d R_SW = (place_.X_WE.linear() * options_.X_ES.linear()).transpose();
  const Eigen::Vector3d p_ES_W = place_.X_WE.linear() * options_.X_ES.translation();
  const int n = static_cast<int>(q_.size());
  Rows J(6, n);  // twist of the origin of S, in S, per joint velocity, over the joint's deviation
  for (int i = 0; i < n; ++i) {
    const auto column = place_.J_W_E.col(i);
    const Eigen::Vector3d turning = column.tail<3>();
    J.col(i) << R_SW * (column.head<3>() + turning.cross(p_ES_W)), R_SW * turning;
    J.col(i) /= deviation_[i];
  }
  math::Matrix6d information;
  information.noalias() = J * J.transpose();
  information.diagonal().head<3>().array() += 1 / (kPriorForce * kPriorForce);
  information.diagonal().tail<3>().array() += 1 / (kPriorTorque * kPriorTorque);
  const Eigen::LDLT<math::Matrix6d> factor(information);
  const Joints weighted = external_.cwiseQuotient(deviation_);
  math::Vector6d fitted;
  fitted.noalias() = J * weighted;
  Contact contact;
  contact.source = options_.source;
  contact.wrench = math::Wrench::from(-factor.solve(fitted));
  contact.covariance = factor.solve(math::Matrix6d::Identity());
  contact.force_deviation = std::sqrt(contact.covariance.diagonal().head<3>().mean());
  contact.torque_deviation = std::sqrt(contact.covariance.diagonal().tail<3>().mean());
  return contact;
}

UpdateResult JointTorque::update(const Signals& signals, ContactSet& contacts) noexcept {
  const Stream<RobotState>& stream = signals.robot;
  unusable_for_ += signals.dt;
  for (int i = 0; i < stream.fresh_count; ++i) {
    const Reading reading = read(stream.fresh[i]);
    if (reading == Reading::kUsable) {
      take(stream.fresh[i]);
      unusable_for_ = 0;
    } else {
      ++skipped_;
      unusable_ = reading;
    }
  }
  if (stream.freshness == Freshness::kNoData) return {Status::kDegraded, "no robot state yet"};
  if (stream.age > options_.max_age) return {Status::kDegraded, "robot state is too old"};
  if (!has_reading_ || unusable_for_ > options_.max_age)
    return {Status::kDegraded, unusable_ == Reading::kWrongCount
                                   ? "ROBOT_STATE has another number of joints than the URDF"
                               : unusable_ == Reading::kNotFinite
                                   ? "joint torques are not finite or not plausible"
                                   : "the arm reports no joint torques"};
  if (options_.tare_at_start && !tare_.is_known())
    return {Status::kDegraded,
            options_.external || friction_.is_known()
                ? "taring"
                : "the tare waits until every joint has moved, which determines its friction"};
  dynamics_.chain().evaluate(q_, place_);
  if (!contacts.push(contact())) return {Status::kDegraded, "no room for another contact"};
  return {};
}

}  // namespace palpate::sensing
