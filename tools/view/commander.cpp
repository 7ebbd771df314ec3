#include "tools/view/commander.hpp"

#include <algorithm>
#include <palpate/channels.hpp>

#include "rt/bus/text.hpp"

namespace palpate::view {
namespace {

constexpr std::int64_t kRepeat = 200'000, kRepeatReplacing = 1'000'000;         // us
constexpr std::int64_t kPatience = 5'000'000, kPatienceReplacing = 60'000'000;  // us

}  // namespace

Commander::Commander(bus::MessageBus& control, const bus::Access& access)
    : commands_(control, channel::kComponentCommand),
      targets_(control, channel::kShapeTarget),
      forces_(control, channel::kManualForce),
      command_sealer_(channel::kComponentCommand, access),
      target_sealer_(channel::kShapeTarget, access),
      force_sealer_(channel::kManualForce, access),
      command_stamp_(bus::random_session()),
      target_stamp_(bus::random_session()),
      force_stamp_(bus::random_session()) {}

void Commander::ask(component_command_t command, std::int64_t now_us, Heard heard) {
  Asked asked;
  command_stamp_.put(command, now_us);
  command_sealer_.put(command, now_us);
  asked.command = command;
  asked.first_counter = command.counter;
  asked.until_us = now_us + kPatience;
  asked.heard = std::move(heard);
  asked_.push_back(std::move(asked));
  send(asked_.back(), now_us);
}

void Commander::ask(std::vector<shape_target_t> target, std::int64_t now_us, Heard heard) {
  // Of several targets waiting for an answer only the last one counts.
  for (auto old = asked_.begin(); old != asked_.end();) {
    if (!old->is_target()) {
      ++old;
      continue;
    }
    old->heard({"", "another target came after it", true});
    old = asked_.erase(old);
  }
  Asked asked;
  asked.target = std::move(target);
  asked.first_counter = -1;
  asked.until_us = now_us + kPatience;
  asked.heard = std::move(heard);
  asked_.push_back(std::move(asked));
  send(asked_.back(), now_us);
}

void Commander::send(Asked& asked, std::int64_t now_us) {
  asked.sent_us = now_us;
  if (!asked.is_target()) {
    // Identical in each repetition, so that the daemon recognises it.
    asked.last_counter = asked.command.counter;
    commands_.publish(asked.command);
    return;
  }
  // The daemon does not answer a repeated target: a new revision of it is answered.
  ++revision_;
  for (shape_target_t& chunk : asked.target) {
    chunk.revision = revision_;
    target_stamp_.put(chunk, now_us);
    target_sealer_.put(chunk, now_us);
    asked.last_counter = chunk.counter;
    if (asked.first_counter < 0) asked.first_counter = asked.last_counter;
    targets_.publish(chunk);
  }
}

void Commander::push(const double (&rest_point)[3], const double (&force)[3], std::int64_t now_us) {
  manual_force_t message{};
  std::copy_n(rest_point, 3, message.rest_point);
  std::copy_n(force, 3, message.force);
  force_stamp_.put(message, now_us);
  force_sealer_.put(message, now_us);
  forces_.publish(message);
}

void Commander::hear(const component_event_t& event) {
  const std::string name = bus::get_text(event.event);
  const bool of_target = std::string_view(bus::get_text(event.slot)) == "feature" &&
                         (name == "target" || name == "refused");
  for (auto asked = asked_.begin(); asked != asked_.end(); ++asked) {
    if (event.command_counter < asked->first_counter || event.command_counter > asked->last_counter)
      continue;
    if (name == "no_access") {
      // Signed before the daemon's start, so that the daemon would never accept it: send a new one.
      if (asked->is_target() || event.command_counter != asked->last_counter) continue;
      const std::int64_t now = bus::wall_clock_us();
      command_stamp_.put(asked->command, now);
      command_sealer_.put(asked->command, now);
      return;
    }
    // Counters of targets and of commands may coincide.
    if (asked->is_target() && !of_target) continue;
    if (!asked->is_target() && name == "target") continue;
    if (name == "replacing") {
      if (!asked->replacing) {
        asked->replacing = true;
        asked->until_us += kPatienceReplacing - kPatience;
        asked->heard({name, bus::get_text(event.reason), false});
      }
      return;
    }
    // Repeated after another command: it was received, and its answer is in transit or lost.
    if (name == "repeated" && asked->replacing) return;
    const Heard heard = std::move(asked->heard);
    asked_.erase(asked);
    heard({name, bus::get_text(event.reason), true});
    return;
  }
}

void Commander::service(std::int64_t now_us) {
  for (auto asked = asked_.begin(); asked != asked_.end();) {
    if (now_us >= asked->until_us) {
      const Heard heard = std::move(asked->heard);
      const bool replacing = asked->replacing;
      asked = asked_.erase(asked);
      heard({"",
             replacing ? "the replacement has begun, but its end was not heard of"
                       : "no answer; does palpated run, and on this control URL?",
             true});
      continue;
    }
    if (now_us - asked->sent_us >= (asked->replacing ? kRepeatReplacing : kRepeat))
      send(*asked, now_us);
    ++asked;
  }
}

}  // namespace palpate::view
