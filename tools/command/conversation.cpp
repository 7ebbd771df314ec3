#include "tools/command/conversation.hpp"

#include <algorithm>
#include <chrono>

#include "rt/daemon/text.hpp"

namespace palpate::command {
namespace {
using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kRepeat{200};
constexpr std::int64_t kPatience = 20'000'000;  // ns, of one look at the bus
}  // namespace

Conversation::Conversation(bus::MessageBus& control, bus::MessageBus& housekeeping,
                           const bus::Access& access)
    : housekeeping_(housekeeping),
      events_(housekeeping, "COMPONENT_EVENT", 64),
      commands_(control, "COMPONENT_COMMAND"),
      targets_(control, "SHAPE_TARGET"),
      command_sealer_("COMPONENT_COMMAND", access),
      target_sealer_("SHAPE_TARGET", access),
      command_stamp_(bus::random_session()),
      target_stamp_(bus::random_session()) {
  housekeeping_.start_without_thread();
}

/// `send`: sends, and returns the counter of what it sent; counters do not fall.
template <class Send>
Answer Conversation::wait(Send send, double timeout) {
  const auto end = Clock::now() + std::chrono::duration<double>(timeout);
  const std::int64_t first = send();
  std::int64_t last = first;
  auto again = Clock::now() + kRepeat;
  Answer answer;
  while (Clock::now() < end) {
    housekeeping_.receive(kPatience);
    component_event_t event;
    std::int64_t arrival_ns = 0;
    while (events_.take(event, arrival_ns)) {
      const std::string name = daemon::get_text(event.event);
      if (name == "no_access") answer.reason = name + ": " + daemon::get_text(event.reason);
      if (event.command_counter < first || event.command_counter > last) continue;
      if (name == "replacing") {
        answer.reason = "the replacement has begun, but its end was not heard of";
        continue;
      }
      return {name, daemon::get_text(event.reason)};
    }
    if (Clock::now() < again) continue;
    last = send();
    again = Clock::now() + kRepeat;
  }
  return answer;
}

Answer Conversation::ask(component_command_t command, double timeout) {
  const std::int64_t now = bus::wall_clock_us();
  command_stamp_.put(command, now);
  command_sealer_.put(command, now);
  // The same each time, so that the daemon knows it again.
  return wait(
      [&] {
        commands_.publish(command);
        return command.counter;
      },
      timeout);
}

Answer Conversation::ask(shape_target_t target, double timeout) {
  // A daemon is silent where a target comes again: a new revision of it is answered.
  --target.revision;
  return wait(
      [&] {
        const std::int64_t now = bus::wall_clock_us();
        ++target.revision;
        target_stamp_.put(target, now);
        target_sealer_.put(target, now);
        targets_.publish(target);
        return target.counter;
      },
      timeout);
}

}  // namespace palpate::command
