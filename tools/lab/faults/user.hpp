#pragma once

#include <algorithm>
#include <palpate/channels.hpp>
#include <palpate/component_command_t.hpp>
#include <palpate/shape_target_t.hpp>
#include <string>

#include "rt/bus/message_bus.hpp"
#include "rt/bus/text.hpp"

namespace palpate::faults {

/// Sends a user's commands and targets.
class User {
 public:
  explicit User(bus::MessageBus& bus)
      : commands_(bus, channel::kComponentCommand), targets_(bus, channel::kShapeTarget) {}

  /// Sets `slot` to `instance`: the event replace; parameters are YAML.
  void send(const char* event, const char* slot = "all", const char* component = "",
            const std::string& parameters = "", const char* instance = "") {
    component_command_t message{};
    message.session = 1;
    message.counter = ++counter_;
    bus::put_text(message.slot, slot);
    bus::put_text(message.instance, instance);
    bus::put_text(message.event, event);
    bus::put_text(message.component, component);
    bus::put_text(message.parameters, parameters);
    commands_.publish(message);
  }

  /// `again`: repeats the last one, as a retransmission does.
  void send_target(const char* kind, const Eigen::VectorXd& value, bool again = false) {
    shape_target_t message{};
    message.session = 1;
    message.revision = again ? revision_ : ++revision_;
    message.chunks = 1;
    bus::put_text(message.kind, kind);
    message.value_count = static_cast<int>(value.size());
    std::copy_n(value.data(), value.size(), message.values);
    targets_.publish(message);
  }

 private:
  bus::TypedPublisher<component_command_t> commands_;
  bus::TypedPublisher<shape_target_t> targets_;
  std::int64_t counter_ = 0;
  std::int32_t revision_ = 0;
};

}  // namespace palpate::faults
