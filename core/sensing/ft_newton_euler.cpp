#include "core/sensing/ft_newton_euler.hpp"

#include <algorithm>
#include <cmath>

#include "core/math/option_check.hpp"

namespace palpate::sensing {
namespace {

double smoothing(double cutoff, double rate) {
  math::check_not_negative(cutoff, "cutoff");
  math::check_positive(rate, "sample_rate");
  return cutoff > 0 ? 1 - std::exp(-2 * M_PI * cutoff / rate) : 1.0;
}

/// Weight of a new value in a first-order low-pass.
double share(double dt, double time_constant) noexcept {
  return dt >= time_constant ? 1.0 : dt / time_constant;
}

}  // namespace

void AccelerometerOffset::follow(const Eigen::Vector3d& acceleration_S, double step,
                                 const Velocity& velocity) noexcept {
  // s, largest gap between two velocities; beyond it the clock has jumped
  constexpr double kLongestGap = 0.1;
  constexpr double kShortestMean = 0.03;  // s, limits the effect of the noise of two velocities
  if (!(memory_ > 0) || !(step > 0)) return;
  if (!velocity.linear.allFinite()) {
    pause();
    return;
  }
  const double gap = velocity.time - before_.time;
  const Eigen::Vector3d change = velocity.linear - before_.linear;
  const bool follows = has_velocity_ && gap >= 0 && gap < kLongestGap;
  before_ = velocity;
  has_velocity_ = true;
  if (!follows) return;
  age_ += step;
  // The changes of the velocity sum to its total change, regardless of delay and noise of each.
  const double over = std::max({step, kShortestMean, std::min(age_, memory_)});
  value_S_ += (step * (acceleration_S - value_S_) - velocity.R_WS.transpose() * change) / over;
}

void AccelerometerOffset::reset() noexcept {
  value_S_.setZero();
  age_ = 0;
  pause();
}

FtNewtonEuler::FtNewtonEuler(const Options& options)
    : TaredModel(options.tare_samples),
      options_(options),
      low_pass_(smoothing(options.cutoff, options.sample_rate)),
      offset_(options.imu_offset_time) {
  math::check_polarity(options.polarity);
  math::check_positive(options.max_age, "max_age");
  math::check_positive(options.imu_max_age, "imu_max_age");
  math::check_not_negative(options.imu_offset_time, "imu_offset_time");
  math::check_not_negative(options.angular_acceleration_time, "angular_acceleration_time");
  math::check_not_negative(options.rest_speed, "rest_speed");
  math::check_positive(options.rest_smoothing, "rest_smoothing");
  math::check_positive(options.rest_acceleration, "rest_acceleration");
  math::check_not_negative(options.payload.mass, "payload.mass");
  const math::Pose X_SI = options.X_ES.inverse() * options.X_EI;
  R_SI_ = X_SI.linear();
  p_SI_ = X_SI.translation();
  if (options.tare_at_start) tare_.start();
}

void FtNewtonEuler::reset() noexcept {
  tare_.reset();
  if (options_.tare_at_start) tare_.start();
  low_pass_.reset();
  has_output_ = has_inertial_ = has_inertial_pair_ = used_imu_ = false;
  usual_step_ = speed_time_ = rested_ = 0;
  angular_acceleration_I_.setZero();
  speed_.setZero();
  latest_.setZero();
  smoothed_.setZero();
  offset_.reset();
}

void FtNewtonEuler::follow_imu(const Stream<Inertial>& stream) noexcept {
  inertial_step_ = 0;
  // After a gap there is no previous sample; the age is measured by the local clock.
  if (stream.fresh_count == 0 && stream.age > options_.imu_max_age) has_inertial_ = false;
  for (int i = 0; i < stream.fresh_count; ++i) {
    const Inertial& sample = stream.fresh[i];
    if (!sample.acceleration_I.allFinite() || !sample.angular_velocity_I.allFinite() ||
        !std::isfinite(sample.time)) {
      ++skipped_;
      continue;
    }
    const double dt = has_inertial_ ? step_between(inertial_.time, sample.time) : 0;
    if (dt > 0) {
      const Eigen::Vector3d raw = (sample.angular_velocity_I - inertial_.angular_velocity_I) / dt;
      angular_acceleration_I_ +=
          share(dt, options_.angular_acceleration_time) * (raw - angular_acceleration_I_);
      has_inertial_pair_ = true;
      inertial_step_ += dt;
    } else {
      angular_acceleration_I_.setZero();
      has_inertial_pair_ = false;
    }
    inertial_ = sample;
    has_inertial_ = true;
  }
}

/// s between two consecutive samples, 0 if unknown. The sender's clock may jump: only intervals
/// near the usual one update it, and implausible intervals are replaced by it, so that a jump has
/// no lasting effect.
double FtNewtonEuler::step_between(double before, double now) noexcept {
  constexpr double kNear = 0.6, kFollows = 0.05;
  const double dt = now - before;
  const bool can_be = dt > 0 && dt < options_.imu_max_age;
  if (usual_step_ == 0) return usual_step_ = can_be ? dt : 0;
  if (!can_be) return usual_step_;
  if (std::abs(dt - usual_step_) > kNear * usual_step_) return dt;  // some samples were lost
  usual_step_ += kFollows * (dt - usual_step_);
  return usual_step_;
}

/// 0 at rest, 1 in motion, by the speed that the robot reports.
double FtNewtonEuler::moving_share(const RobotState& robot) noexcept {
  constexpr double kSmoothing = 0.02;  // s
  constexpr double kLever = 0.3;       // m
  const math::Vector6d twist = robot.V_W_E.vector();
  if (!twist.allFinite()) return 1;
  const double dt = robot.time - speed_time_;
  const bool follows = dt >= 0 && dt < options_.max_age;
  speed_ += (follows ? share(dt, kSmoothing) : 1.0) * (twist - speed_);
  speed_time_ = robot.time;
  const double speed = std::max(speed_.head<3>().norm(), kLever * speed_.tail<3>().norm());
  return std::clamp(speed / options_.rest_speed - 1, 0.0, 1.0);
}

/// At rest the mean of the accelerations since the hand came to rest, over at most rest_smoothing.
/// The mean restarts from the latest ones where these differ: when the hand sets off, and while it
/// slows down.
void FtNewtonEuler::smooth(const RobotState& robot, Eigen::Vector3d& acceleration,
                           Eigen::Vector3d& angular_acceleration) noexcept {
  constexpr double kLatest = 0.015;  // s
  constexpr double kSudden = 2.5;    // change at once, relative to that of the latest mean
  math::Vector6d both;
  both << acceleration, angular_acceleration;
  const double sudden = (acceleration - smoothed_.head<3>()).norm();
  const double by_speed = moving_share(robot);
  const double moving =
      std::max(by_speed, std::clamp(sudden / (kSudden * options_.rest_acceleration) - 1, 0.0, 1.0));
  if (inertial_step_ > 0) {
    latest_ += share(inertial_step_, kLatest) * (both - latest_);
    rested_ += inertial_step_;
    smoothed_ +=
        share(inertial_step_, std::min(rested_, options_.rest_smoothing)) * (both - smoothed_);
    const double change = (latest_ - smoothed_).head<3>().norm();
    if (by_speed > 0 || change > options_.rest_acceleration) {
      smoothed_ = latest_;
      rested_ = kLatest;
    }
  }
  both = moving * both + (1 - moving) * smoothed_;
  acceleration = both.head<3>();
  angular_acceleration = both.tail<3>();
}

/// Velocity of the origin of S as reported by the robot.
AccelerometerOffset::Velocity FtNewtonEuler::velocity(const RobotState& robot,
                                                      const Eigen::Matrix3d& R_WS) const noexcept {
  const Eigen::Vector3d p_ES_W = robot.X_WE.linear() * options_.X_ES.translation();
  return {robot.time, robot.V_W_E.linear + robot.V_W_E.angular.cross(p_ES_W), R_WS};
}

LoadMotion FtNewtonEuler::motion(const Signals& signals) noexcept {
  const Eigen::Matrix3d R_WS = signals.robot.latest.X_WE.linear() * options_.X_ES.linear();
  LoadMotion motion = motion_at_rest(R_WS, options_.gravity_W);
  follow_imu(signals.inertial);
  used_imu_ = options_.use_imu && has_inertial_pair_ &&
              signals.inertial.freshness != Freshness::kNoData &&
              signals.inertial.age <= options_.imu_max_age;
  if (!used_imu_) return motion;

  motion.angular_velocity = R_SI_ * inertial_.angular_velocity_I;
  motion.angular_acceleration = R_SI_ * angular_acceleration_I_;
  // from the origin of I to that of S on the same rigid body
  const Eigen::Vector3d offset = -p_SI_;
  const Eigen::Vector3d specific_force =
      R_SI_ * inertial_.acceleration_I + motion.angular_acceleration.cross(offset) +
      motion.angular_velocity.cross(motion.angular_velocity.cross(offset));
  const Eigen::Vector3d acceleration = specific_force - motion.specific_force;
  // m/s^2, plausible maximum for an arm; more is an overload or an invalid measurement
  constexpr double kLargestMotion = 30;
  if (acceleration.norm() < kLargestMotion)
    offset_.follow(acceleration, inertial_step_, velocity(signals.robot.latest, R_WS));
  else
    offset_.pause();
  Eigen::Vector3d true_acceleration = acceleration - offset_.value_S();
  if (options_.rest_speed > 0)
    smooth(signals.robot.latest, true_acceleration, motion.angular_acceleration);
  motion.specific_force += true_acceleration;
  return motion;
}

UpdateResult FtNewtonEuler::update(const Signals& signals, ContactSet& contacts) noexcept {
  const auto& stream = signals.force_torque;
  const bool robot_known = signals.robot.freshness != Freshness::kNoData &&
                           signals.robot.age <= options_.max_age &&
                           signals.robot.latest.X_WE.matrix().allFinite();
  if (!robot_known) {
    used_imu_ = false;
    follow_imu(signals.inertial);
    offset_.pause();
    return {Status::kDegraded, "robot state is absent or too old"};
  }
  const math::Vector6d explained = load_wrench(options_.payload, motion(signals)).vector();
  for (int i = 0; i < stream.fresh_count; ++i) {
    const math::Vector6d reading = options_.polarity * stream.fresh[i].F_S.vector();
    if (!reading.allFinite()) {
      ++skipped_;
      continue;
    }
    const math::Vector6d rest = reading - explained;
    tare_.update(rest);
    low_pass_.update(rest);
    has_output_ = true;
  }

  if (stream.freshness == Freshness::kNoData || !has_output_)
    return {Status::kDegraded, "no force-torque reading yet"};
  if (stream.age > options_.max_age) return {Status::kDegraded, "force-torque reading is too old"};
  if (options_.tare_at_start && !tare_.is_known()) return {Status::kDegraded, "taring"};

  Contact contact;
  contact.source = options_.source;
  contact.wrench = math::Wrench::from(low_pass_.value() - tare_.offset());
  contact.force_deviation = options_.force_deviation;
  contact.torque_deviation = options_.torque_deviation;
  if (!contacts.push(contact)) return {Status::kDegraded, "no room for another contact"};
  // gravity remains compensated, but not the inertial forces
  const Stream<Inertial>& inertial = signals.inertial;
  if (options_.use_imu && inertial.freshness != Freshness::kNoData &&
      inertial.age > options_.imu_max_age)
    return {Status::kDegraded, "inertial reading is too old"};
  return {};
}

}  // namespace palpate::sensing
