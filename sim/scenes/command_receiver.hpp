#pragma once

#include <cstdint>
#include <palpate/hand_command_t.hpp>
#include <palpate/joint_velocity_command_t.hpp>
#include <palpate/twist_command_t.hpp>
#include <string>

#include "rt/bus/authentication.hpp"
#include "rt/bus/message_bus.hpp"
#include "rt/bus/session.hpp"
#include "sim/robot/robot.hpp"
#include "sim/scenes/hand_control.hpp"

namespace palpate::scenes {

/// Passes the daemon's commands to arm and hand as a robot's driver does: the newest counts, an
/// invalid one stops the arm, a malformed one is rejected and counted. With a key, commands without
/// a valid authentication code or with an old counter are rejected as well: a stray program cannot
/// move the arm.
class CommandReceiver {
 public:
  /// Of arm 0 or 1. Construct before the bus starts.
  explicit CommandReceiver(bus::MessageBus& control, int arm = 0,
                           const std::optional<bus::Key>& key = {});

  /// From now on rejects commands signed before `start_us`, wall clock.
  void begin(std::int64_t start_us);

  /// Applies the commands that move the arm.
  void apply(robot::Robot& robot);
  void apply(HandControl& hand);

  std::int64_t accepted() const { return accepted_; }
  std::int64_t rejected() const { return rejected_; }
  /// Number of the rejected commands without a valid code or with an old counter.
  std::int64_t unauthorised() const;
  /// Number of lost commands: gaps in the sequences, and drops by a full queue.
  std::int64_t lost() const;

 private:
  template <class Message>
  struct Input {
    Input(bus::MessageBus& control, const std::string& channel, const std::optional<bus::Key>& key);
    std::int64_t lost() const { return order.lost() + queue.counters().dropped; }
    bus::TypedSubscription<Message> queue;
    bus::ReplayGuard admission;
    bus::SequenceTracker order;
  };
  /// Passes on what has arrived; `take` returns false for a message to be rejected.
  template <class Message, class Take>
  void drain(Input<Message>& input, Take take);

  int arm_;
  Input<twist_command_t> twists_;
  Input<joint_velocity_command_t> joints_;
  Input<hand_command_t> hands_;
  std::int64_t accepted_ = 0;
  std::int64_t rejected_ = 0;
};

}  // namespace palpate::scenes
