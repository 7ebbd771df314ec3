#pragma once

#include <palpate/component_command_t.hpp>
#include <palpate/component_event_t.hpp>
#include <palpate/shape_target_t.hpp>
#include <string>

#include "rt/bus/authentication.hpp"
#include "rt/bus/message_bus.hpp"
#include "rt/bus/session.hpp"

namespace palpate::command {

/// What the daemon said to a command.
struct Answer {
  std::string event;   // empty: nothing
  std::string reason;  // also where nothing was answered, as far as it is known
  bool done() const { return !event.empty() && event != "refused"; }
};

/// Commands to a daemon, each sent again until it is answered; the daemon carries it out once.
class Conversation {
 public:
  /// Subscribes and starts `housekeeping`, which must not have been started.
  Conversation(bus::MessageBus& control, bus::MessageBus& housekeeping, const bus::Access& access);

  /// Waits for the last word, at most `timeout` s: for a replacement that is how it ended.
  Answer ask(component_command_t command, double timeout);
  Answer ask(shape_target_t target, double timeout);

 private:
  template <class Send>
  Answer wait(Send send, double timeout);

  bus::MessageBus& housekeeping_;
  bus::TypedSubscription<component_event_t> events_;
  bus::TypedPublisher<component_command_t> commands_;
  bus::TypedPublisher<shape_target_t> targets_;
  bus::Sealer command_sealer_, target_sealer_;
  bus::Stamp command_stamp_, target_stamp_;
};

}  // namespace palpate::command
