#include "tools/command/conversation.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

#include "rt/bus/text.hpp"

namespace palpate::command {
namespace {
using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kRepeat{200};
constexpr std::int64_t kPatience = 20'000'000;  // ns, polling interval of the bus
}  // namespace

Conversation::Conversation(bus::MessageBus& control, bus::MessageBus& housekeeping,
                           const bus::Access& access)
    : control_(control),
      housekeeping_(housekeeping),
      features_(control, "FEATURE", 64),
      events_(housekeeping, "COMPONENT_EVENT", 64),
      commands_(control, "COMPONENT_COMMAND"),
      targets_(control, "SHAPE_TARGET"),
      command_sealer_("COMPONENT_COMMAND", access),
      target_sealer_("SHAPE_TARGET", access),
      command_stamp_(bus::random_session()),
      target_stamp_(bus::random_session()) {
  housekeeping_.start_without_thread();
}

/// `send`: sends, and returns the counter of the message; counters do not decrease. `renew` is
/// called if it was signed before the daemon started, which would never accept it.
template <class Send, class Renew>
Answer Conversation::wait(Send send, Renew renew, double timeout) {
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
      const std::string name = bus::get_text(event.event);
      if (name == "no_access") answer.reason = name + ": " + bus::get_text(event.reason);
      if (event.command_counter < first || event.command_counter > last) continue;
      if (name == "no_access") {
        if (event.command_counter == last) renew();
        continue;
      }
      if (name == "replacing") {
        answer.reason = "the replacement has begun, but its end was not heard of";
        continue;
      }
      return {name, bus::get_text(event.reason)};
    }
    if (Clock::now() < again) continue;
    last = send();
    again = Clock::now() + kRepeat;
  }
  return answer;
}

Answer Conversation::ask(component_command_t command, double timeout) {
  const auto seal = [&] {
    const std::int64_t now = bus::wall_clock_us();
    command_stamp_.put(command, now);
    command_sealer_.put(command, now);
  };
  seal();
  // Identical in each repetition, so that the daemon recognises it.
  const auto send = [&] {
    commands_.publish(command);
    return command.counter;
  };
  return wait(send, seal, timeout);
}

Answer Conversation::ask(std::vector<shape_target_t> target, double timeout) {
  // The daemon does not answer a repeated target: a new revision of it is answered, with the
  // counter of the chunk that completed it.
  int revision = target.at(0).revision - 1;
  const auto send = [&] {
    ++revision;
    for (shape_target_t& chunk : target) {
      const std::int64_t now = bus::wall_clock_us();
      chunk.revision = revision;
      target_stamp_.put(chunk, now);
      target_sealer_.put(chunk, now);
      targets_.publish(chunk);
    }
    return target.back().counter;
  };
  const Answer answer = wait(
      send, [] {}, timeout);
  revision_ = revision;
  return answer;
}

std::optional<double> Conversation::follow(double within, double timeout) {
  const auto end = Clock::now() + std::chrono::duration<double>(timeout);
  control_.start_without_thread();
  std::optional<double> error;
  while (Clock::now() < end && !(error && *error <= within)) {
    control_.receive(kPatience);
    feature_t feature;
    std::int64_t arrival_ns = 0;
    while (features_.take(feature, arrival_ns)) {
      if (feature.revision != revision_) continue;
      const int count = std::clamp(feature.error_count, 0, 32);
      error =
          std::sqrt(std::inner_product(feature.error, feature.error + count, feature.error, 0.));
    }
  }
  return error;
}

}  // namespace palpate::command
