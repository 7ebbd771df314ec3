#include "franka.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>
#include <utility>

namespace palpate::franka_bridge {
namespace {

constexpr std::int64_t kMilli = 1'000'000;
constexpr std::int64_t kStart = 3000 * kMilli;     // ns until a motion that is asked for must run
constexpr std::int64_t kRest = 2000 * kMilli;      // ns at rest after which it ends
constexpr std::int64_t kToEnd = 2000 * kMilli;     // ns until it must have ended
constexpr std::int64_t kLeft = 300 * kMilli;       // ns in which an ended one may still be reported
constexpr std::int64_t kReported = 100 * kMilli;   // ns that an end counts as a stop, which latches
constexpr std::int64_t kRecovery = 1000 * kMilli;  // ns in a reflex until it is left
constexpr std::int64_t kAtExit = 500 * kMilli;
constexpr double kLoad = 1e-3;   // kg, by which the load may differ
constexpr double kStill = 1e-6;  // rad/s

Eigen::Isometry3d pose_of(const std::array<double, 16>& columns) {
  Eigen::Isometry3d X;
  X.matrix() = Eigen::Map<const Eigen::Matrix4d>(columns.data());
  return X;
}

bool is_still(const Seven& dq) {
  return std::all_of(dq.begin(), dq.end(), [](double speed) { return std::abs(speed) < kStill; });
}

}  // namespace

Franka::Franka(std::unique_ptr<bridge::Stream> stream, std::unique_ptr<Datagrams> datagrams,
               Options options)
    : options_(std::move(options)),
      client_(std::move(stream), std::move(datagrams)),
      follower_(options_.limits) {}

void Franka::receive() {
  const std::int64_t now_ns = options_.now_ns();
  client_.poll(now_ns);
  taken_ = 0;
  if (!client_.is_running()) {
    if (motion_ != Motion::kNone) end_motion(nullptr, now_ns);
    recovery_ns_.reset();
  }
  follow_answers(now_ns);
}

std::string Franka::complaint() {
  std::string text = std::exchange(remark_, {});
  return text.empty() ? client_.next_remark() : text;
}

bool Franka::foreign_command() { return std::exchange(foreign_, false); }

bool Franka::take(bridge::Reading& reading) {
  const std::int64_t now_ns = options_.now_ns();
  const RobotState* state = client_.take();
  if (state == nullptr) return false;
  state_ = *state;
  if (++taken_ > 1) ++late_;
  follow_motion(now_ns);
  follow_reflex(now_ns);
  if (options_.wrench) read_wrench();
  const auto joints = [](const Seven& numbers) {
    return Eigen::Map<const Eigen::Matrix<double, kJoints, 1>>(numbers.data());
  };
  reading.utime = 1 + 1000 * static_cast<std::int64_t>(state_.id);
  reading.arrival_ns = now_ns;
  reading.q = joints(state_.q);
  reading.dq = joints(state_.dq);
  reading.tau.setZero(kJoints);
  if (options_.torque == Torque::kMeasured) reading.tau = joints(state_.tau_J);
  if (options_.torque == Torque::kExternal) reading.tau = joints(state_.tau_ext);
  const char* const halted = halt_of(state_.mode);
  reading.halted = halted != nullptr ? halted : ended_;
  return true;
}

void Franka::read_wrench() {
  const bool is_other = !(std::abs(state_.load - options_.wrench->payload) <= kLoad);
  if (is_other && !has_other_payload_)
    remark_ = "no wrench: the arm subtracts a payload of " + std::to_string(state_.load) +
              " kg; wrench.payload is " + std::to_string(options_.wrench->payload);
  has_other_payload_ = is_other;
  const Eigen::Isometry3d X_EK = pose_of(state_.X_FE) * pose_of(state_.X_EK);
  const Eigen::Map<const Eigen::Vector3d> force_K(state_.F_K.data());
  const Eigen::Map<const Eigen::Vector3d> torque_K(state_.F_K.data() + 3);
  const Eigen::Vector3d force = options_.wrench->polarity * (X_EK.linear() * force_K);
  const Eigen::Vector3d torque =
      options_.wrench->polarity * (X_EK.linear() * torque_K) + X_EK.translation().cross(force);
  wrench_S_ = {force, torque};
  has_wrench_ = !is_other && force.allFinite() && torque.allFinite();
}

bool Franka::take(math::Wrench& wrench_S) {
  if (!std::exchange(has_wrench_, false)) return false;
  wrench_S = wrench_S_;
  return true;
}

void Franka::follow_motion(std::int64_t now_ns) {
  if (now_ns - motion_ns_ > kReported) ended_ = nullptr;
  switch (motion_) {
    case Motion::kNone:
      if (state_.mode == RobotMode::kMove && now_ns - motion_ns_ > kLeft) foreign_ = true;
      return;
    case Motion::kStarting:
      if (state_.is_moving()) {
        motion_ = Motion::kRunning;
        motion_ns_ = now_ns;
      } else if (halt_of(state_.mode) != nullptr || now_ns - motion_ns_ > kStart) {
        end_motion("the arm does not begin the motion", now_ns);
      }
      return;
    case Motion::kRunning:
      if (!state_.is_moving()) end_motion("the arm has ended the motion", now_ns);
      return;
    case Motion::kEnding:
      if (!state_.is_moving())
        end_motion(nullptr, now_ns);
      else if (now_ns - motion_ns_ > kToEnd)
        end_motion("the arm does not end the motion", now_ns);
      return;
  }
}

void Franka::follow_answers(std::int64_t now_ns) {
  while (const std::optional<FciClient::Answer> answer = client_.take_answer()) {
    if (answer->request == Request::kAutomaticErrorRecovery && answer->status != 0)
      remark_ = "the arm refuses to leave its error; clear it at the arm or in Desk";
    const bool is_end = answer->request == Request::kMove && answer->number == move_ &&
                        answer->status != kMotionStarted;
    if (!is_end || (motion_ != Motion::kStarting && motion_ != Motion::kRunning)) continue;
    remark_ = "the motion: " + move_status_name(answer->status);
    end_motion("the arm has ended the motion", now_ns);
  }
}

void Franka::follow_reflex(std::int64_t now_ns) {
  if (state_.mode != RobotMode::kReflex) {
    recovery_ns_.reset();
    return;
  }
  if (!recovery_ns_) {
    recovery_ns_ = now_ns + kRecovery;
    remark_ = "reflex of the arm: " + names_of(state_.reflex_reason);
  }
  if (!options_.recovers || now_ns < *recovery_ns_) return;
  recovery_ns_ = now_ns + kStart;
  client_.request(Request::kAutomaticErrorRecovery);
}

void Franka::end_motion(const char* why, std::int64_t now_ns) {
  motion_ = Motion::kNone;
  motion_ns_ = now_ns;
  ended_ = why;
  if (why != nullptr) may_start_ = false;
}

void Franka::send(const Joints& dq, std::int64_t /*utime*/) {
  const std::int64_t now_ns = options_.now_ns();
  if (dq.isZero(0)) {
    may_start_ = true;
  } else {
    wanted_ns_ = now_ns;
    if (motion_ == Motion::kNone && may_start_ && state_.mode == RobotMode::kIdle) {
      move_ = client_.request(Request::kMove);
      motion_ = Motion::kStarting;
      motion_ns_ = now_ns;
      ++motions_;
    }
  }
  answer(dq, now_ns);
}

void Franka::answer(const Joints& dq, std::int64_t now_ns) {
  if (motion_ != Motion::kRunning && motion_ != Motion::kEnding) return;
  Seven wanted{};
  if (motion_ == Motion::kRunning) std::copy(dq.data(), dq.data() + kJoints, wanted.begin());
  const Seven next = follower_.next(wanted, state_);
  if (!std::all_of(next.begin(), next.end(), [](double speed) { return std::isfinite(speed); }))
    return;
  const bool rests = is_still(next) && is_still(state_.dq_d);
  if (motion_ == Motion::kRunning && rests && now_ns - wanted_ns_ > kRest) {
    motion_ = Motion::kEnding;
    motion_ns_ = now_ns;
  }
  client_.command(next, motion_ == Motion::kEnding && rests);
}

void Franka::wait(std::int64_t until_ns) {
  // Datagrams of others must not hurry the cycle, whose limits are those of 1 ms.
  using Clock = std::chrono::steady_clock;
  std::this_thread::sleep_until(Clock::time_point(std::chrono::nanoseconds(until_ns - kMilli / 2)));
  client_.wait(until_ns + kMilli);
}

void Franka::finish() {
  const Joints zero = Joints::Zero(kJoints);
  const std::int64_t begin_ns = options_.now_ns();
  bridge::Reading reading;
  while (motion_ != Motion::kNone && options_.now_ns() - begin_ns < kAtExit) {
    wait(options_.now_ns());
    receive();
    bool is_new = false;
    while (take(reading)) is_new = true;
    if (motion_ == Motion::kRunning) {
      motion_ = Motion::kEnding;
      motion_ns_ = options_.now_ns();
    }
    if (is_new) answer(zero, options_.now_ns());
  }
}

}  // namespace palpate::franka_bridge
