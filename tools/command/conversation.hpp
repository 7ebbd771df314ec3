#pragma once

#include <optional>
#include <palpate/component_command_t.hpp>
#include <palpate/component_event_t.hpp>
#include <palpate/feature_t.hpp>
#include <palpate/shape_target_t.hpp>
#include <string>
#include <vector>

#include "rt/bus/authentication.hpp"
#include "rt/bus/message_bus.hpp"
#include "rt/bus/session.hpp"

namespace palpate::command {

/// The daemon's answer to a command.
struct Answer {
  std::string event;   // empty: no answer
  std::string reason;  // as far as known, also without an answer
  bool done() const { return !event.empty() && event != "refused"; }
};

/// Sends commands to a daemon and repeats each until it is answered; the daemon executes it once.
class Conversation {
 public:
  /// Subscribes to both buses and starts `housekeeping`; neither must have been started.
  Conversation(bus::MessageBus& control, bus::MessageBus& housekeeping, const bus::Access& access);

  /// Waits for the final answer, at most `timeout` s: for a replacement, its result.
  Answer ask(component_command_t command, double timeout);
  /// The chunks of one target.
  Answer ask(std::vector<shape_target_t> target, double timeout);

  /// After an accepted target, once: waits until the norm of the feature error is at most `within`
  /// (m, rad or 1/m, as the feature's), at most `timeout` s. Returns the last received error; empty
  /// if there was none.
  std::optional<double> follow(double within, double timeout);

 private:
  template <class Send, class Renew>
  Answer wait(Send send, Renew renew, double timeout);

  bus::MessageBus& control_;
  bus::MessageBus& housekeeping_;
  bus::TypedSubscription<feature_t> features_;
  bus::TypedSubscription<component_event_t> events_;
  bus::TypedPublisher<component_command_t> commands_;
  bus::TypedPublisher<shape_target_t> targets_;
  bus::MessageSigner command_sealer_, target_sealer_;
  bus::HeaderStamper command_stamp_, target_stamp_;
  int revision_ = -1;  // of the last target
};

}  // namespace palpate::command
