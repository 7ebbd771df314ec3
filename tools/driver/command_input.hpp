#pragma once

#include <palpate/joint_velocity_command_t.hpp>
#include <palpate/twist_command_t.hpp>

#include "arm.hpp"
#include "rt/bus/authentication.hpp"
#include "rt/bus/message_bus.hpp"
#include "rt/bus/session.hpp"

namespace palpate::driver {

/// Current command of the daemon.
struct Command {
  enum class Kind { kStop, kTwist, kJoints };
  Kind kind = Kind::kStop;
  math::Twist V_W_E;  // of kTwist
  Joints dq;          // of kJoints
};

struct Counts {
  std::int64_t obeyed = 0;
  std::int64_t unauthorised = 0;  // without a valid code, or signed before the start
  std::int64_t rejected = 0;      // late, for another arm, or not finite
  std::int64_t silences = 0;      // watchdog stops: no further commands arrived
};

/// Receives TWIST_COMMAND and JOINT_VELOCITY_COMMAND, and selects the command to follow: it must
/// have a valid code if there is a key, be newer than all before, be for the first arm and finite.
/// A command whose `valid` is not 1 is a stop, and so is silence. Keep this class unchanged.
class CommandInput {
 public:
  static constexpr std::int64_t kSilence = 100'000'000;  // ns without a command until a stop

  CommandInput(bus::MessageBus& control, int joint_count, const bus::Access& access);

  /// State at `now_ns` of CLOCK_MONOTONIC, after the bus has received.
  const Command& read(std::int64_t now_ns);
  Counts counts() const;
  /// Number of zero commands received from the daemon.
  std::int64_t rest_commands() const { return rest_commands_; }

 private:
  template <class Message>
  struct Channel {
    Channel(bus::MessageBus& control, const char* name, const bus::Access& access)
        : commands(control, name, 64), admission(name, access) {}
    bus::TypedSubscription<Message> commands;
    bus::ReplayGuard admission;
    bus::SequenceTracker order;
  };

  template <class Message, class Take>
  void drain(Channel<Message>& channel, Take take);
  bool take(const twist_command_t& message);
  bool take(const joint_velocity_command_t& message);

  int joint_count_;
  Channel<twist_command_t> twists_;
  Channel<joint_velocity_command_t> joints_;
  Command command_;
  std::int64_t good_ns_ = 0;
  std::int64_t rest_commands_ = 0;
  Counts counts_;
};

}  // namespace palpate::driver
