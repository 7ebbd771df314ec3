#include "rt/daemon/commands.hpp"

#include <cstdio>
#include <palpate/channels.hpp>

#include "rt/bus/text.hpp"

namespace palpate::daemon {

using pipeline::Event;
using pipeline::LifeCycle;

namespace {

// Bounds the work per cycle under a message flood.
constexpr int kMostCommandsPerCycle = 4;

}  // namespace

Commands::Commands(bus::MessageBus& control, bus::MessageBus& housekeeping, std::int64_t session,
                   const bus::Access& access)
    : commands_(control, channel::kComponentCommand, 8),
      targets_(control, channel::kShapeTarget, 2 * TargetAssembly::kMostChunks),
      command_admission_(channel::kComponentCommand, access),
      target_admission_(channel::kShapeTarget, access),
      events_(housekeeping, channel::kComponentEvent, session, bus::Urgency::kLater) {}

void Commands::handle(pipeline::Pipeline& pipeline, Replacing& replacing, std::int64_t cycle,
                      std::int64_t utime) noexcept {
  std::int64_t arrival_ns = 0;
  for (int i = 0; i < kMostCommandsPerCycle && commands_.take(command_, arrival_ns); ++i)
    handle_command(pipeline, replacing, cycle, utime);
  for (int i = 0; i < kMostCommandsPerCycle && targets_.take(target_, arrival_ns); ++i)
    handle_target(pipeline, utime);
}

void Commands::handle_command(pipeline::Pipeline& pipeline, Replacing& replacing,
                              std::int64_t cycle, std::int64_t utime) noexcept {
  const bus::Admitted admitted = command_admission_.judge(command_);
  if (admitted == bus::Admitted::kRejected) return;
  const char* slot = bus::get_text(command_.slot);
  const Event event = pipeline::event_from(bus::get_text(command_.event));
  if (command_.session == last_session_ && command_.counter == last_counter_) {
    // A repeated command means that the acknowledgement was lost. Not logged, because a sender that
    // repeats itself indefinitely would fill the log.
    say(slot, last_answer_.data(), command_.counter, last_reason_.data(), utime);
    return;
  }
  if (admitted == bus::Admitted::kRepeated ||
      (command_.session == last_session_ && command_.counter < last_counter_)) {
    say(slot, "repeated", command_.counter, "was carried out before", utime);
    return;
  }
  last_session_ = command_.session;
  last_counter_ = command_.counter;

  const char* done = pipeline::name(event);
  const char* reason = "";
  switch (event) {
    case Event::kStart:
      reason = pipeline.start();
      if (*reason != '\0') done = "refused";
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
  remember_answer(done, reason);
  answer(slot, done, command_.counter, reason, utime);
}

void Commands::handle_target(pipeline::Pipeline& pipeline, std::int64_t utime) noexcept {
  if (target_admission_.judge(target_) != bus::Admitted::kFresh) return;
  const char* reason = "";
  const TargetAssembly::Taken taken = assembly_.take(target_, reason);
  if (taken == TargetAssembly::Taken::kWaits || taken == TargetAssembly::Taken::kKnown) return;
  const bool accepted = taken == TargetAssembly::Taken::kWhole &&
                        pipeline.set_target(assembly_.revision(), assembly_.kind(),
                                            assembly_.rest_points(), assembly_.point_count(),
                                            assembly_.values(), assembly_.value_count(), reason);
  answer("feature", accepted ? "target" : "refused", target_.counter, reason, utime);
}

void Commands::announce_rejected(Admissions others, std::int64_t monotonic_ns,
                                 std::int64_t utime) noexcept {
  constexpr std::int64_t kInterval = 1'000'000'000;  // ns
  if (rejected_reported_ns_ != 0 && monotonic_ns - rejected_reported_ns_ < kInterval) return;
  const bus::ReplayGuard* admissions[] = {&command_admission_, &target_admission_, others[0],
                                          others[1], others[2]};
  for (std::size_t i = 0; i < rejected_reported_.size(); ++i) {
    const std::int64_t more = admissions[i]->rejected() - rejected_reported_[i];
    if (more == 0) continue;
    rejected_reported_[i] += more;
    rejected_reported_ns_ = monotonic_ns;
    char reason[200];
    std::snprintf(reason, sizeof(reason), "%lld of %s, the last one: %s",
                  static_cast<long long>(more), admissions[i]->channel().c_str(),
                  admissions[i]->reason());
    // With this counter a sender can recognise that its message preceded the start, and sign it
    // again.
    const std::int64_t counter =
        admissions[i] == &command_admission_ ? command_admission_.before_start() : -1;
    answer("all", "no_access", counter, reason, utime);
    return;  // the next channel follows one second later
  }
}

void Commands::announce(const Replacing& replacing, Replacing::Outcome outcome,
                        std::int64_t utime) noexcept {
  const component_command_t& command = replacing.command();
  bus::put_text(event_.instance, bus::get_text(command.instance));
  bus::put_text(event_.component, bus::get_text(command.component));
  const bool replaced = outcome == Replacing::Outcome::kReplaced;
  const char* done = replaced ? "replaced" : "refused";
  if (command.session == last_session_ && command.counter == last_counter_)
    remember_answer(done, replacing.reason());
  answer(bus::get_text(command.slot), done, command.counter, replacing.reason(), utime);
  bus::put_text(event_.instance, "");
  bus::put_text(event_.component, "");
}

void Commands::announce(const pipeline::Condition& condition, std::int64_t utime) noexcept {
  char reason[200];
  put_reason(condition, reason);
  answer("all", pipeline::name(condition.state), -1, reason, utime);
}

void Commands::announce(const char* slot, const char* instance, const char* component,
                        const char* event, const char* reason, std::int64_t utime) noexcept {
  bus::put_text(event_.instance, instance);
  bus::put_text(event_.component, component);
  answer(slot, event, -1, reason, utime);
  bus::put_text(event_.instance, "");
  bus::put_text(event_.component, "");
}

void Commands::announce_wrong_type(const bus::Subscription& channel, std::int64_t utime) noexcept {
  char reason[200];
  std::snprintf(reason, sizeof(reason),
                "%s: messages of type 0x%016llx are rejected, 0x%016llx is expected",
                channel.channel().c_str(),
                static_cast<unsigned long long>(channel.counters().last_wrong_fingerprint),
                static_cast<unsigned long long>(channel.fingerprint()));
  answer("bus", "wrong type", -1, reason, utime);
}

void Commands::remember_answer(const char* event, const char* reason) noexcept {
  bus::put_text(last_answer_, event);
  bus::put_text(last_reason_, reason);
}

void Commands::answer(const char* slot, const char* event, std::int64_t counter, const char* reason,
                      std::int64_t utime) noexcept {
  say(slot, event, counter, reason, utime);
  EventRecord record;
  bus::put_text(record.event, event);
  bus::put_text(record.component, bus::get_text(event_.instance));
  bus::put_text(record.reason, reason);
  log_.push(record);
}

void Commands::say(const char* slot, const char* event, std::int64_t counter, const char* reason,
                   std::int64_t utime) noexcept {
  bus::put_text(event_.slot, slot);
  bus::put_text(event_.event, event);
  bus::put_text(event_.reason, reason);
  event_.command_counter = counter;
  events_.publish(event_, utime);
}

}  // namespace palpate::daemon
