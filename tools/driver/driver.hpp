#pragma once

#include <csignal>
#include <functional>
#include <palpate/ft_wrench_t.hpp>
#include <palpate/robot_state_t.hpp>

#include "joint_guard.hpp"

namespace palpate::driver {

/// ROBOT_STATE at 500 Hz and FT_WRENCH at 1 kHz, or as often as the arm has new ones.
class Telemetry {
 public:
  Telemetry(bus::MessageBus& control, const kinematics::SerialChain& chain);

  /// `utime`: us, wall clock. After a restart of the arm under a new session, which palpated
  /// answers by waiting for start.
  void publish(const ArmState& arm, std::int64_t utime);

 private:
  kinematics::SerialChain chain_;
  kinematics::SerialChain::State pose_;
  robot_state_t state_{};
  bus::TypedPublisher<robot_state_t> states_;
  bus::TypedPublisher<ft_wrench_t> wrenches_;
  bus::HeaderStamper state_stamp_, wrench_stamp_;
  bool published_ = false;  // in the last cycle
};

/// After an emergency stop the arm stays at rest until the daemon itself has commanded zero
/// (palpate-command stop, then start): releasing the button does not request motion.
class StopLatch {
 public:
  /// Whether the arm must rest. `rest_commands`: see CommandInput.
  bool holds(const ArmState& arm, std::int64_t rest_commands);

 private:
  bool held_ = false;
  std::int64_t before_ = 0;
};

/// Between palpated and an arm: command input, joint guard, stop latch and telemetry. Keep this
/// class unchanged.
class Driver {
 public:
  static constexpr double kPeriod = 1e-3;  // s, of cycle()

  /// Commands are obeyed on the bus `control`, with the key of `access`; call before it starts.
  Driver(bus::MessageBus& control, const kinematics::SerialChain& chain,
         const JointGuard::Options& guard, const bus::Access& access, Arm& arm);

  /// One cycle, after the bus has received. `now_ns`: CLOCK_MONOTONIC; `utime`: us, wall clock.
  void cycle(std::int64_t now_ns, std::int64_t utime);
  /// Commands zero.
  void stop() { arm_.command(still_); }
  Counts counts() const { return input_.counts(); }

 private:
  Arm& arm_;
  JointGuard guard_;
  StopLatch latch_;
  CommandInput input_;
  Telemetry telemetry_;
  ArmState state_;
  const Command rest_;
  Joints still_;
};

/// Cycles by the clock until `ended` is not 0, then stops the arm and prints the counts. Starts the
/// bus. `also`, if any, is called in every cycle with the wall clock, us. `wait`, if any, waits for
/// the next cycle, due at the given CLOCK_MONOTONIC, ns, and may return earlier or later: for an
/// arm that wants each state answered at once.
void run(Driver& driver, bus::MessageBus& control, const volatile std::sig_atomic_t& ended,
         const std::function<void(std::int64_t utime)>& also = {},
         const std::function<void(std::int64_t until_ns)>& wait = {});

}  // namespace palpate::driver
