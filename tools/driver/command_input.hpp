#pragma once

#include <palpate/joint_velocity_command_t.hpp>
#include <palpate/twist_command_t.hpp>

#include "arm.hpp"
#include "rt/bus/authentication.hpp"
#include "rt/bus/message_bus.hpp"
#include "rt/bus/session.hpp"

namespace palpate::driver {

/// What the daemon wants now.
struct Command {
  enum class Kind { kStop, kTwist, kJoints };
  Kind kind = Kind::kStop;
  math::Twist V_W_E;  // of kTwist
  Joints dq;          // of kJoints
};

struct Counts {
  std::int64_t obeyed = 0;
  std::int64_t refused = 0;   // without a valid code, or sent before
  std::int64_t rejected = 0;  // late, of another arm, or not numbers
  std::int64_t silences = 0;  // stops because commands had ceased to come
};

/// Takes TWIST_COMMAND and JOINT_VELOCITY_COMMAND, and decides what of them to obey: what has a
/// valid code where there is a key, is newer than all before, is for the first arm and finite. What
/// is not valid (1) is a stop, and so is silence. Keep this as it is.
class CommandInput {
 public:
  static constexpr std::int64_t kSilence = 100'000'000;  // ns without a command: a stop

  CommandInput(bus::MessageBus& control, int joint_count, const bus::Access& access);

  /// At `now_ns` of CLOCK_MONOTONIC, after the bus has received.
  const Command& read(std::int64_t now_ns);
  Counts counts() const;
  /// How often the daemon has said that nothing shall move.
  std::int64_t told_to_rest() const { return told_to_rest_; }

 private:
  template <class Message>
  struct Channel {
    Channel(bus::MessageBus& control, const char* name, const bus::Access& access)
        : commands(control, name, 64), admission(name, access) {}
    bus::TypedSubscription<Message> commands;
    bus::Admission admission;
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
  std::int64_t told_to_rest_ = 0;
  Counts counts_;
};

}  // namespace palpate::driver
