#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <palpate/component_command_t.hpp>
#include <palpate/component_event_t.hpp>
#include <palpate/manual_force_t.hpp>
#include <palpate/shape_target_t.hpp>
#include <string>
#include <vector>

#include "rt/bus/authentication.hpp"
#include "rt/bus/message_bus.hpp"
#include "rt/bus/session.hpp"

namespace palpate::view {

/// Sends commands to a daemon asynchronously: each is repeated until it is answered, and the result
/// is reported by a callback. Several may be pending. To be used from one thread.
class Commander {
 public:
  struct Answer {
    std::string event;  // reported by the daemon; empty: time-out
    std::string reason;
    bool last = true;  // false: "replacing", still in progress
  };
  using Heard = std::function<void(const Answer&)>;

  /// Publishes on `control`, which must outlive this object.
  Commander(bus::MessageBus& control, const bus::Access& access);

  /// `now_us`: wall clock, here and below.
  void ask(component_command_t command, std::int64_t now_us, Heard heard);
  /// The chunks of one target.
  void ask(std::vector<shape_target_t> target, std::int64_t now_us, Heard heard);

  /// Sends one MANUAL_FORCE, which expires in the daemon after 100 ms: to keep pushing, repeat it.
  /// `rest_point`: in O, m; `force`: in O, N.
  void push(const double (&rest_point)[3], const double (&force)[3], std::int64_t now_us);

  /// Handles an event published by the daemon.
  void hear(const component_event_t& event);
  /// Repeats commands and handles time-outs; call several times per second.
  void service(std::int64_t now_us);

  std::size_t under_way() const { return asked_.size(); }

 private:
  struct Asked {
    component_command_t command{};
    std::vector<shape_target_t> target;  // chunks of a target; empty: it is a command
    bool is_target() const { return !target.empty(); }
    std::int64_t first_counter = 0, last_counter = 0;
    std::int64_t sent_us = 0, until_us = 0;
    bool replacing = false;
    Heard heard;
  };
  void send(Asked& asked, std::int64_t now_us);

  bus::TypedPublisher<component_command_t> commands_;
  bus::TypedPublisher<shape_target_t> targets_;
  bus::TypedPublisher<manual_force_t> forces_;
  bus::MessageSigner command_sealer_, target_sealer_, force_sealer_;
  bus::HeaderStamper command_stamp_, target_stamp_, force_stamp_;
  std::int32_t revision_ = 0;
  std::list<Asked> asked_;
};

}  // namespace palpate::view
