#include "core/control/guarded_motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/math/option_check.hpp"

namespace palpate::control {
namespace {

constexpr double kRecordResolution = 5e-5;  // m
constexpr double kSettling = 0.1;           // s, at rest before the baseline
constexpr double kUnusable = 1;             // s, that inputs may be unusable before the approach
constexpr double kMostDistance = 1, kLeastSpeed = 1e-5;  // m, m/s

double or_default(double value, double configured) noexcept {
  return value == 0 ? configured : value;
}

}  // namespace

GuardedMotion::GuardedMotion(const Options& options, double speed_limit)
    : options_(options), speed_limit_(speed_limit), record_(kRecordResolution), fit_(options.fit) {
  math::check_option(options.speed >= kLeastSpeed && options.speed <= speed_limit, "speed",
                     options.speed,
                     "from 1e-5 to gate.linear_speed, " + std::to_string(speed_limit));
  math::check_positive_finite(options.distance, "distance");
  math::check_not_negative(options.retreat, "retreat");
  math::check_positive_finite(options.acceleration, "acceleration");
  math::check_all_finite(options.tip_G, "tip_in_grasp");
  math::check_not_negative(options.tip_radius, "tip_radius");
  math::check_positive_finite(options.baseline_time, "baseline_time");
  math::check_not_negative(options.hold_time, "hold_time");
  math::check_positive_finite(options.force_smoothing, "force_smoothing");
  math::check_positive_finite(options.force_limit, "force_limit");
  math::check_not_negative(options.force_delay, "force_delay");
}

const char* GuardedMotion::begin(const TouchRequest& request) noexcept {
  if (is_running()) return "another guarded motion is running";
  TouchRequest wanted = request;
  const double length = request.direction_W.stableNorm();
  if (!std::isfinite(length) || !(length > 0)) return "direction must be finite and not zero";
  wanted.direction_W /= length;
  wanted.speed = or_default(request.speed, options_.speed);
  wanted.distance = or_default(request.distance, options_.distance);
  wanted.retreat = or_default(request.retreat, options_.retreat);
  if (!(wanted.force > 0 && wanted.force <= options_.force_limit))
    return "force must be above 0 and at most control.force_limit";
  if (!(wanted.speed >= kLeastSpeed && wanted.speed <= speed_limit_))
    return "speed must be at least 1e-5 m/s and at most gate.linear_speed";
  if (!(wanted.distance > 0 && wanted.distance <= kMostDistance))
    return "distance must be above 0 and at most 1 m";
  if (!(wanted.retreat >= 0 && wanted.retreat <= kMostDistance))
    return "retreat must be at least 0 and at most 1 m";
  request_ = wanted;
  report_ = TouchReport();
  report_.state = TouchState::kWaiting;
  speed_ = smoothed_ = largest_ = force_sum_ = 0;
  force_count_ = 0;
  is_armed_ = gives_way_ = false;
  record_.clear();
  enter(Phase::kBaseline);
  return "";
}

void GuardedMotion::enter(Phase phase) noexcept {
  phase_ = phase;
  time_ = watched_time_ = 0;
}

void GuardedMotion::stop(const char* reason) noexcept {
  if (is_running()) finish(TouchState::kStopped, reason);
}

void GuardedMotion::put_reason(const char* reason) noexcept {
  std::snprintf(report_.reason.data(), report_.reason.size(), "%s", reason);
}

void GuardedMotion::finish(TouchState state, const char* reason) noexcept {
  report_.state = state;
  report_.force = largest_;
  if (state != TouchState::kTouched) put_reason(reason);
  speed_ = 0;
  enter(Phase::kRest);
}

void GuardedMotion::compute(const LawInputs&, LawOutput& output) noexcept {
  output.V_O_G = output.V_O_G_second = math::Twist();
  output.remark = "";
}

GuardedMotion::Sample GuardedMotion::measure(const Inputs& inputs) const noexcept {
  Sample sample;
  sample.tip_W = inputs.X_WG * options_.tip_G;
  sample.travel = request_.direction_W.dot(sample.tip_W - start_W_);
  const double zero = force_count_ > 0 ? force_sum_ / force_count_ : 0;
  sample.force = request_.direction_W.dot(inputs.force_W) - zero;
  return sample;
}

Eigen::Vector3d GuardedMotion::advance(const Inputs& inputs) noexcept {
  if (!is_running()) return Eigen::Vector3d::Zero();
  time_ += inputs.dt;
  const Sample sample = measure(inputs);
  const bool is_usable =
      inputs.is_usable && sample.tip_W.allFinite() && std::isfinite(sample.force);
  if (inputs.is_rejected) {
    stop(inputs.gate_reason);
  } else if (!is_usable) {
    const char* reason = inputs.is_usable ? "pose or force is not finite" : inputs.reason;
    if (phase_ != Phase::kBaseline || time_ > kSettling + options_.baseline_time + kUnusable)
      stop(reason);
  } else {
    switch (phase_) {
      case Phase::kBaseline:
        baseline(inputs);
        break;
      case Phase::kApproach:
        approach(inputs, sample);
        break;
      case Phase::kBrake:
        brake(inputs, sample);
        break;
      case Phase::kRetreat:
        retreat(inputs, sample);
        break;
      case Phase::kRest:
        break;
    }
  }
  return speed_ * request_.direction_W;
}

/// Mean force at rest.
void GuardedMotion::baseline(const Inputs& inputs) noexcept {
  if (time_ < kSettling) return;
  force_sum_ += request_.direction_W.dot(inputs.force_W);
  ++force_count_;
  if (force_count_ * inputs.dt < options_.baseline_time) return;
  start_W_ = inputs.X_WG * options_.tip_G;
  report_.state = TouchState::kApproaching;
  enter(Phase::kApproach);
}

void GuardedMotion::change_speed(double wanted, double dt) noexcept {
  const double most = options_.acceleration * dt;
  speed_ += std::clamp(wanted - speed_, -most, most);
}

/// False, after stopping the motion, if the hand has covered less than a quarter of the way that
/// was commanded in the last half second.
bool GuardedMotion::follows(const Inputs& inputs, const Sample& sample) noexcept {
  constexpr double kWindow = 0.5, kShare = 0.25;  // s
  if (watched_time_ == 0) {
    watched_travel_ = sample.travel;
    watched_way_ = 0;
  }
  watched_time_ += inputs.dt;
  watched_way_ += speed_ * inputs.dt;
  if (watched_time_ < kWindow) return true;
  watched_time_ = 0;
  if (std::abs(sample.travel - watched_travel_) >= kShare * std::abs(watched_way_)) return true;
  const bool is_limited = *inputs.gate_reason != '\0';
  std::array<char, 100> reason{};
  std::snprintf(reason.data(), reason.size(), "%s%s",
                is_limited ? "limited by the gate: " : "the robot does not follow the command",
                is_limited ? inputs.gate_reason : "");
  stop(reason.data());
  return false;
}

/// Speed from which the hand still stops after `left` m, at least a tenth of that of the request.
double GuardedMotion::speed_towards(double left, double dt) const noexcept {
  const double slow = 0.1 * request_.speed;
  return std::clamp(approach_speed(left, options_.acceleration, dt), slow, request_.speed);
}

void GuardedMotion::approach(const Inputs& inputs, const Sample& sample) noexcept {
  constexpr double kReached = 1e-4;  // m, from the end of the line
  largest_ = std::max(largest_, smoothed_);
  report_.travel = sample.travel;
  report_.force = smoothed_;
  if (sample.force > options_.force_limit) return give_way(sample);
  if (!follows(inputs, sample)) return;
  const double left = request_.distance - sample.travel;
  if (left < kReached) return finish(TouchState::kNoContact, "no contact within the distance");
  change_speed(speed_towards(left, inputs.dt), inputs.dt);
  // Before that the hand's own inertia, as far as it is not compensated, looks like a contact.
  if (!is_armed_ && speed_ < request_.speed) return;
  is_armed_ = true;
  record_.add(sample.travel - speed_ * options_.force_delay, sample.force);
  smoothed_ += std::min(1.0, inputs.dt / options_.force_smoothing) * (sample.force - smoothed_);
  if (smoothed_ < request_.force) return;
  contact_ = sample;
  fit_.begin(record_);
  report_.state = TouchState::kRetreating;
  enter(Phase::kBrake);
}

/// Comes to rest, and evaluates the approach meanwhile.
void GuardedMotion::brake(const Inputs& inputs, const Sample& sample) noexcept {
  report_.travel = sample.travel;
  largest_ = std::max(largest_, sample.force);
  if (sample.force > options_.force_limit) return give_way(sample);
  change_speed(0, inputs.dt);
  if (!fit_.done()) fit_.advance();
  if (speed_ > 0 || time_ < options_.hold_time || !fit_.done()) return;
  conclude();
  enter(Phase::kRetreat);
}

/// Backs off although the approach has not been evaluated.
void GuardedMotion::give_way(const Sample& sample) noexcept {
  largest_ = std::max(largest_, sample.force);
  gives_way_ = true;
  goal_ = std::max(0.0, sample.travel - request_.retreat);
  report_.state = TouchState::kRetreating;
  enter(Phase::kRetreat);
}

void GuardedMotion::conclude() noexcept {
  const contact::IndentationFit::Result& result = fit_.result();
  const double touch = result.valid ? result.touch : contact_.travel;
  report_.centre_W = contact_.tip_W + (touch - contact_.travel) * request_.direction_W;
  report_.point_W = report_.centre_W + options_.tip_radius * request_.direction_W;
  if (result.valid) {
    report_.point_deviation = result.touch_deviation;
    report_.indentation = result.indentation;
    report_.stiffness = result.stiffness;
    report_.stiffness_deviation = result.stiffness_deviation;
  } else {
    put_reason(result.reason);
  }
  goal_ = std::max(0.0, touch - request_.retreat);
}

void GuardedMotion::retreat(const Inputs& inputs, const Sample& sample) noexcept {
  constexpr double kReached = 1e-4;  // m
  report_.travel = sample.travel;
  report_.force = sample.force;
  if (-sample.force > options_.force_limit)
    return finish(TouchState::kStopped, "force above its limit while backing off");
  const double left = sample.travel - goal_;
  if (speed_ <= 0 && left < kReached) {
    if (gives_way_) return finish(TouchState::kStopped, "force above control.force_limit");
    return finish(TouchState::kTouched, "");
  }
  if (!follows(inputs, sample)) return;
  change_speed(-speed_towards(left, inputs.dt), inputs.dt);
}

}  // namespace palpate::control
