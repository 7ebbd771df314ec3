#include "rt/daemon/commands.hpp"

#include <algorithm>
#include <cstdio>
#include <cstring>

#include "rt/daemon/text.hpp"

namespace palpate::daemon {

using component::Event;
using component::LifeCycle;

Commands::Commands(bus::MessageBus& control, bus::MessageBus& housekeeping, std::int64_t session)
    : commands_(control, "COMPONENT_COMMAND", 8),
      targets_(control, "SHAPE_TARGET", 4),
      stamp_(session),
      events_(housekeeping, "COMPONENT_EVENT") {}

void Commands::handle(component::Pipeline& pipeline, Replacing& replacing, std::int64_t cycle,
                      std::int64_t utime) noexcept {
  std::int64_t arrival_ns = 0;
  while (commands_.take(command_, arrival_ns)) handle_command(pipeline, replacing, cycle, utime);
  while (targets_.take(target_, arrival_ns)) handle_target(pipeline, utime);
}

void Commands::handle_command(component::Pipeline& pipeline, Replacing& replacing,
                              std::int64_t cycle, std::int64_t utime) noexcept {
  const char* slot = get_text(command_.slot);
  const Event event = component::event_from(get_text(command_.event));
  const bool repeated = command_.session == last_session_ && command_.counter <= last_counter_;
  if (repeated) {
    answer(slot, "repeated", command_.counter, "was carried out before", utime);
    return;
  }
  last_session_ = command_.session;
  last_counter_ = command_.counter;

  const char* done = component::name(event);
  const char* reason = "";
  switch (event) {
    case Event::kStart:
      pipeline.start();
      if (!pipeline.is_running()) done = "refused", reason = "faulted: reset first";
      break;
    case Event::kStop:
      pipeline.stop();
      break;
    case Event::kReset:
      pipeline.reset();
      break;
    case Event::kZero:
    case Event::kCalibrate:
      pipeline.zero();
      break;
    case Event::kReplace:
      reason = replacing.request(command_, cycle);
      done = *reason == '\0' ? "replacing" : "refused";
      break;
    case Event::kUnknown:
      done = "refused";
      reason = "unknown event; known: start, stop, reset, zero, calibrate, replace";
      break;
  }
  answer(slot, done, command_.counter, reason, utime);
}

void Commands::handle_target(component::Pipeline& pipeline, std::int64_t utime) noexcept {
  if (target_.session == target_session_ && target_.revision <= target_revision_) return;
  target_session_ = target_.session;
  target_revision_ = target_.revision;
  const char* reason = "";
  bool accepted = false;
  if (target_.chunks != 1 || target_.chunk != 0) {
    reason = "targets in several chunks are not understood";
  } else if (target_.point_count < 0 || target_.point_count > 64 || target_.value_count < 0 ||
             target_.value_count > 192 || target_.revision < 0) {
    reason = "target with counts out of range";
  } else {
    accepted =
        pipeline.set_target(target_.revision, get_text(target_.kind), target_.rest_points,
                            target_.point_count, target_.values, target_.value_count, reason);
  }
  answer("feature", accepted ? "target" : "refused", target_.counter, reason, utime);
}

void Commands::announce(const Replacing& replacing, Replacing::Outcome outcome,
                        std::int64_t utime) noexcept {
  const component_command_t& command = replacing.command();
  put_text(event_.instance, get_text(command.instance));
  put_text(event_.component, get_text(command.component));
  const bool replaced = outcome == Replacing::Outcome::kReplaced;
  answer(get_text(command.slot), replaced ? "replaced" : "refused", command.counter,
         replacing.reason(), utime);
  put_text(event_.instance, "");
  put_text(event_.component, "");
}

void Commands::announce(const WrongType& wrong, std::int64_t utime) noexcept {
  std::array<char, 160> reason{};
  std::snprintf(reason.data(), reason.size(), "%s: messages of type %016llx, not %016llx",
                wrong.channel, static_cast<unsigned long long>(wrong.received),
                static_cast<unsigned long long>(wrong.expected));
  answer("inputs", "wrong type", -1, reason.data(), utime);
}

void Commands::announce(const component::Condition& condition, std::int64_t utime) noexcept {
  answer("all", component::name(condition.state), -1, condition.reason, utime);
}

void Commands::answer(const char* slot, const char* event, std::int64_t counter, const char* reason,
                      std::int64_t utime) noexcept {
  stamp_.put(event_, utime);
  put_text(event_.slot, slot);
  put_text(event_.event, event);
  put_text(event_.reason, reason);
  event_.command_counter = counter;
  events_.publish(event_);
  EventRecord record;
  put_text(record.event, event);
  put_text(record.reason, reason);
  log_.push(record);
}

}  // namespace palpate::daemon
