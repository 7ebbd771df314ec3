#include "driver.hpp"

#include <chrono>
#include <cstdio>
#include <palpate/channels.hpp>
#include <thread>

namespace palpate::driver {

Telemetry::Telemetry(bus::MessageBus& control, const kinematics::SerialChain& chain)
    : chain_(chain),
      states_(control, channel::kRobotState),
      wrenches_(control, channel::kFtWrench),
      state_stamp_(bus::random_session()),
      wrench_stamp_(bus::random_session()) {
  state_.joint_count = chain.joint_count();
}

void Telemetry::publish(const ArmState& arm, std::int64_t utime) {
  if (arm.restarted) state_stamp_ = bus::HeaderStamper(bus::random_session());
  if (arm.has_wrench) {
    ft_wrench_t reading{};
    Eigen::Map<math::Vector6d>(reading.wrench) << arm.wrench_S.force, arm.wrench_S.torque;
    wrench_stamp_.put(reading, utime);
    wrenches_.publish(reading);
  }
  published_ = arm.is_new && !published_;  // every second cycle
  if (!published_) return;
  const int n = chain_.joint_count();
  chain_.evaluate(arm.q, pose_);
  Eigen::Map<Eigen::VectorXd>(state_.q, n) = arm.q;
  Eigen::Map<Eigen::VectorXd>(state_.dq, n) = arm.dq;
  Eigen::Map<Eigen::VectorXd>(state_.tau, n) = arm.tau;
  Eigen::Map<Eigen::Vector3d>(state_.position) = pose_.X_WE.translation();
  math::wxyz_from_rotation(pose_.X_WE.linear(), state_.quaternion);
  Eigen::Map<math::Vector6d>(state_.twist) = pose_.J_W_E * arm.dq;
  state_stamp_.put(state_, utime);
  states_.publish(state_);
}

bool StopLatch::holds(const ArmState& arm, std::int64_t rest_commands) {
  if (arm.stopped) {
    if (!held_) std::fprintf(stderr, "%s: rests until palpated is stopped\n", arm.stop_reason);
    held_ = true;
    before_ = rest_commands;
  } else if (held_ && rest_commands > before_) {
    std::fprintf(stderr, "palpated has stopped: may move again\n");
    held_ = false;
  }
  return held_;
}

Driver::Driver(bus::MessageBus& control, const kinematics::SerialChain& chain,
               const JointGuard::Options& guard, const bus::Access& access, Arm& arm)
    : arm_(arm),
      guard_(chain, guard),
      input_(control, chain.joint_count(), access),
      telemetry_(control, chain) {
  still_.setZero(chain.joint_count());
}

void Driver::cycle(std::int64_t now_ns, std::int64_t utime) {
  const Command& wanted = input_.read(now_ns);
  if (arm_.read(state_)) {
    const bool held = latch_.holds(state_, input_.rest_commands());
    arm_.command(guard_.limit(held ? rest_ : wanted, state_.q));
    telemetry_.publish(state_, utime);
  } else {
    guard_.reset();
    arm_.command(still_);
  }
}

void run(Driver& driver, bus::MessageBus& control, const volatile std::sig_atomic_t& ended,
         const std::function<void(std::int64_t utime)>& also,
         const std::function<void(std::int64_t until_ns)>& wait) {
  using Clock = std::chrono::steady_clock;  // CLOCK_MONOTONIC, as times of arrival
  const auto period =
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(Driver::kPeriod));
  control.start_without_thread();
  auto next = Clock::now();
  while (ended == 0) {
    control.receive(0);
    const std::int64_t utime = bus::wall_clock_us();
    driver.cycle(Clock::now().time_since_epoch() / std::chrono::nanoseconds(1), utime);
    if (also) also(utime);
    next += period;
    if (next < Clock::now()) next = Clock::now();  // late: missed cycles are not made up
    if (!wait) {
      std::this_thread::sleep_until(next);
      continue;
    }
    wait(next.time_since_epoch() / std::chrono::nanoseconds(1));
    next = Clock::now();
  }
  driver.stop();
  const Counts counts = driver.counts();
  std::printf("%lld obeyed, %lld unauthorised, %lld rejected, %lld stops by the watchdog\n",
              static_cast<long long>(counts.obeyed), static_cast<long long>(counts.unauthorised),
              static_cast<long long>(counts.rejected), static_cast<long long>(counts.silences));
}

}  // namespace palpate::driver
