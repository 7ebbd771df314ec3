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

/// Gives commands to a daemon without waiting for it: each is sent again until it is answered, and
/// what becomes of it is told by a call. Several may be under way. All from one thread.
class Commander {
 public:
  struct Answer {
    std::string event;  // as the daemon says; empty: nothing came in time
    std::string reason;
    bool last = true;  // false: "replacing", whose end is yet to come
  };
  using Heard = std::function<void(const Answer&)>;

  /// Publishes on `control`, which outlives this.
  Commander(bus::MessageBus& control, const bus::Access& access);

  /// `now_us`: wall clock, here and below.
  void ask(component_command_t command, std::int64_t now_us, Heard heard);
  /// The chunks of one target.
  void ask(std::vector<shape_target_t> target, std::int64_t now_us, Heard heard);

  /// Sends one MANUAL_FORCE, which the daemon forgets after 100 ms: to push on, renew it.
  /// `rest_point`: in O, m; `force`: in O, N.
  void push(const double (&rest_point)[3], const double (&force)[3], std::int64_t now_us);

  /// An event that the daemon published.
  void hear(const component_event_t& event);
  /// Repeats and gives up, several times a second.
  void service(std::int64_t now_us);

  std::size_t under_way() const { return asked_.size(); }

 private:
  struct Asked {
    component_command_t command{};
    std::vector<shape_target_t> target;  // its chunks; none: it is a command
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
  bus::Sealer command_sealer_, target_sealer_, force_sealer_;
  bus::Stamp command_stamp_, target_stamp_, force_stamp_;
  std::int32_t revision_ = 0;
  std::list<Asked> asked_;
};

}  // namespace palpate::view
