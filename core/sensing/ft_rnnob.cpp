#include "core/sensing/ft_rnnob.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "core/math/option_check.hpp"

namespace palpate::sensing {
namespace {

constexpr double kMostRows = 1e6;

int checked_capacity(int width, int window, double largest_delay) {
  math::check_option(width >= 1, "width", width, "at least 1");
  math::check_option(window >= 1, "window", window, "at least 1");
  math::check_not_negative(largest_delay, "largest_delay");
  math::check_option(window + largest_delay <= kMostRows, "window and delay",
                     window + largest_delay, "at most 1e6 samples together");
  return window + static_cast<int>(std::ceil(largest_delay)) + 1;
}

// Column offsets in a row of the history. Quaternion x, y, z, w of S in W; velocity and position of
// S in W; angular velocity and specific force at I in the axes of S; reading in S.
constexpr int kPose = 0, kVelocity = 4, kPosition = 7, kInertial = 10, kWrench = 16;
constexpr int kPoseSize = 10, kInertialSize = 6, kWrenchSize = 6;

int checked_ticks(const FtRnnob::Options& options) {
  math::check_positive(options.rate, "rate");
  math::check_positive(options.period, "period");
  const double ticks = 1 / (options.rate * options.period);
  const double whole = std::round(ticks);
  math::check_option(
      whole >= 1 && std::abs(ticks - whole) <= 1e-6 * whole, "rate", options.rate,
      "a rate of which the loop's, " + std::to_string(1 / options.period) + " Hz, is a multiple");
  return static_cast<int>(whole);
}

/// s, delay of the latest stream relative to the pose.
double latest(const FtRnnob::Options& options) {
  return std::max({0.0, options.inertial_delay, options.force_torque_delay});
}

SignalHistory make_history(const FtRnnob::Options& options, int width) {
  const double least = std::min({0.0, options.inertial_delay, options.force_torque_delay});
  const double window = std::round(options.average / options.period);
  const double delay = (latest(options) - least) / options.period;
  math::check_option(window >= 0 && window <= 1e5, "average", options.average,
                     "0 to 100,000 periods of the loop");
  math::check_option(delay <= 1e5, "delay", delay * options.period,
                     "at most 100,000 periods of the loop");
  return SignalHistory(width, std::max(1, static_cast<int>(window)), delay);
}

}  // namespace

SignalHistory::SignalHistory(int width, int window, double largest_delay)
    : rows_(Eigen::MatrixXd::Zero(width, checked_capacity(width, window, largest_delay))),
      window_(window) {}

void SignalHistory::push(const Eigen::Ref<const Eigen::VectorXd>& row) noexcept {
  const int capacity = static_cast<int>(rows_.cols());
  // After weeks at 1 kHz: reduces the count without changing its effect.
  if (count_ == std::numeric_limits<int>::max()) count_ = capacity + (count_ % capacity);
  rows_.col(count_ % capacity) = row;
  ++count_;
}

void SignalHistory::mean(int first, double delay, Eigen::Ref<Eigen::VectorXd> mean) const noexcept {
  mean.setZero();
  const int rows = std::min(window_, count_);
  const auto capacity = static_cast<int>(rows_.cols());
  const Eigen::Index width = mean.size();
  for (int k = count_ - rows; k < count_; ++k) {
    const double at = std::max(k - delay, 0.0);
    const int left = static_cast<int>(at);
    const double part = at - left;
    mean += (1 - part) * rows_.col(left % capacity).segment(first, width);
    if (part > 0) mean += part * rows_.col((left + 1) % capacity).segment(first, width);
  }
  if (rows > 0) mean /= rows;
}

FtRnnob::FtRnnob(const Options& options, std::unique_ptr<Executor> executor)
    : TaredModel(options.tare_samples),
      options_(options),
      ticks_per_step_(checked_ticks(options)),
      input_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(options.inputs.size()))),
      network_(std::move(executor), options.inputs, options.outputs),
      history_(make_history(options, kWidth)) {
  math::check_option(options.outputs.size() == 6, "outputs", options.outputs.size(), "6 indices");
  for (const int input : options.inputs)
    math::check_option(input < kObserverInputCount, "inputs", input,
                       "below " + std::to_string(kObserverInputCount));
  math::check_polarity(options.polarity);
  math::check_positive(options.max_age, "max_age");
  options.domain.check(static_cast<int>(options.inputs.size()));
  if (options.domain.points.cols() > 0 && !options.network_gives_rest)
    throw std::invalid_argument("domain: " + std::to_string(options.domain.points.cols()) +
                                " points; allowed: none without network_gives_rest");
  math::check_not_negative(options.payload.mass, "payload.mass");
  const math::Pose X_SI = options.X_ES.inverse() * options.X_EI;
  R_SI_ = X_SI.linear();
  p_SI_ = X_SI.translation();
  pose_delay_ = latest(options) / options.period;
  inertial_delay_ = (latest(options) - options.inertial_delay) / options.period;
  wrench_delay_ = (latest(options) - options.force_torque_delay) / options.period;
  if (options.tare_at_start) tare_.start();
}

void FtRnnob::restart() noexcept {
  if (history_.count() == 0 && !has_inertial_ && !has_wrench_) return;
  history_.clear();
  network_.restart();
  has_inertial_ = has_wrench_ = has_rest_ = false;
  previous_xyzw_.setZero();
  row_.setZero();
}

void FtRnnob::reset() noexcept {
  restart();
  network_.reset();
  tare_.reset();
  if (options_.tare_at_start) tare_.start();
}

/// Reason why no output is possible; nullptr if it is.
const char* FtRnnob::missing(const Signals& signals) const noexcept {
  const auto stale = [this](const auto& stream) {
    return stream.freshness == Freshness::kNoData || !(stream.age <= options_.max_age);
  };
  if (stale(signals.robot) || !signals.robot.latest.X_WE.matrix().allFinite() ||
      !signals.robot.latest.V_W_E.vector().allFinite())
    return "robot state is absent or too old";
  if (stale(signals.inertial)) return "inertial reading is absent or too old";
  if (stale(signals.force_torque)) return "force-torque reading is absent or too old";
  return nullptr;
}

/// Updates the row: the present pose, and means of the samples received since the last tick.
void FtRnnob::take(const Signals& signals) noexcept {
  const RobotState& robot = signals.robot.latest;
  const Eigen::Matrix3d R_WS = robot.X_WE.linear() * options_.X_ES.linear();
  Eigen::Vector4d quaternion = Eigen::Quaterniond(R_WS).coeffs();
  if (quaternion.dot(row_.segment<4>(kPose)) < 0) quaternion = -quaternion;
  row_.segment<4>(kPose) = quaternion;
  const Eigen::Vector3d p_ES_W = robot.X_WE.linear() * options_.X_ES.translation();
  row_.segment<3>(kPosition) = robot.X_WE.translation() + p_ES_W;
  row_.segment<3>(kVelocity) = robot.V_W_E.linear + robot.V_W_E.angular.cross(p_ES_W);

  Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
  int count = 0;
  for (int i = 0; i < signals.inertial.fresh_count; ++i) {
    const Inertial& sample = signals.inertial.fresh[i];
    if (!sample.acceleration_I.allFinite() || !sample.angular_velocity_I.allFinite()) {
      ++skipped_;
      continue;
    }
    sum.head<3>() += R_SI_ * sample.angular_velocity_I;
    sum.tail<3>() += R_SI_ * sample.acceleration_I;
    ++count;
  }
  if (count > 0) {
    row_.segment<kInertialSize>(kInertial) = sum / count;
    has_inertial_ = true;
  }

  sum.setZero();
  count = 0;
  for (int i = 0; i < signals.force_torque.fresh_count; ++i) {
    const math::Vector6d reading = options_.polarity * signals.force_torque.fresh[i].F_S.vector();
    if (!reading.allFinite()) {
      ++skipped_;
      continue;
    }
    sum += reading;
    ++count;
  }
  if (count > 0) {
    row_.segment<kWrenchSize>(kWrench) = sum / count;
    has_wrench_ = true;
  }
}

/// Motion of S from the means of angular velocity and specific force at I.
LoadMotion FtRnnob::mean_motion(const Eigen::Matrix<double, 6, 1>& inertial) noexcept {
  LoadMotion motion;
  motion.angular_velocity = inertial.head<3>();
  const bool has_previous = previous_xyzw_.squaredNorm() > 0;
  if (has_previous)
    motion.angular_acceleration = options_.rate * (motion.angular_velocity - previous_rate_S_);
  previous_rate_S_ = motion.angular_velocity;
  // from the origin of I to that of S on the same rigid body
  const Eigen::Vector3d offset = -p_SI_;
  motion.specific_force = inertial.tail<3>() + motion.angular_acceleration.cross(offset) +
                          motion.angular_velocity.cross(motion.angular_velocity.cross(offset));
  return motion;
}

void FtRnnob::step() noexcept {
  Eigen::Matrix<double, kPoseSize, 1> pose;
  Eigen::Matrix<double, kInertialSize, 1> inertial;
  Eigen::Matrix<double, kWrenchSize, 1> reading;
  history_.mean(kPose, pose_delay_, pose);
  history_.mean(kInertial, inertial_delay_, inertial);
  history_.mean(kWrench, wrench_delay_, reading);

  const Eigen::Quaterniond orientation(Eigen::Vector4d(pose.head<4>()));
  math::Pose X_WS = math::Pose::Identity();
  X_WS.linear() = orientation.normalized().toRotationMatrix();
  X_WS.translation() = pose.segment<3>(kPosition);
  const LoadMotion motion = mean_motion(inertial);
  const ObserverInputs inputs =
      observer_inputs(X_WS, pose.segment<3>(kVelocity), motion, options_.gravity_W, previous_xyzw_);
  previous_xyzw_ = inputs.head<4>();
  network_.step(inputs);
  if (!network_.has_answer() && !(network_.has_failed() && options_.fall_back)) return;

  for (std::size_t i = 0; i < options_.inputs.size(); ++i)
    input_[static_cast<Eigen::Index>(i)] = inputs[options_.inputs[i]];
  // the network's output is zero after a failure
  rest_ = reading - options_.domain.trust(input_) * network_.answer();
  if (options_.network_gives_rest || network_.has_failed())
    rest_ -= load_wrench(options_.payload, motion).vector();
  has_rest_ = true;
  tare_.update(rest_);
}

UpdateResult FtRnnob::update(const Signals& signals, ContactSet& contacts) noexcept {
  if (const char* reason = missing(signals)) {
    restart();
    return {Status::kDegraded, reason};
  }
  take(signals);
  if (!has_inertial_ || !has_wrench_) return {Status::kDegraded, "no finite reading yet"};
  if (history_.count() % ticks_per_step_ == 0) {
    history_.push(row_);
    step();
  } else {
    history_.push(row_);
  }

  if (network_.has_failed() && !options_.fall_back)
    return {Status::kFault, "the network of the wrist sensor fails or hangs"};
  if (!has_rest_) return {Status::kDegraded, "no answer of the network yet"};
  if (options_.tare_at_start && !tare_.is_known()) return {Status::kDegraded, "taring"};

  Contact contact;
  contact.source = options_.source;
  contact.wrench = math::Wrench::from(rest_ - tare_.offset());
  contact.force_deviation = options_.force_deviation;
  contact.torque_deviation = options_.torque_deviation;
  if (!contact.wrench.vector().allFinite())
    return {Status::kDegraded, "the contact wrench is not finite"};
  if (!contacts.push(contact)) return {Status::kDegraded, "no room for another contact"};
  if (network_.has_failed())
    return {Status::kDegraded, "the network fails or hangs: payload alone explains the reading"};
  return {};
}

}  // namespace palpate::sensing
