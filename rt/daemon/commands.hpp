#pragma once

#include <array>
#include <boost/lockfree/spsc_queue.hpp>
#include <palpate/component_command_t.hpp>
#include <palpate/component_event_t.hpp>
#include <palpate/shape_target_t.hpp>

#include "rt/bus/authentication.hpp"
#include "rt/bus/message_bus.hpp"
#include "rt/bus/session.hpp"
#include "rt/daemon/inputs.hpp"
#include "rt/daemon/replacing.hpp"
#include "rt/daemon/target_assembly.hpp"
#include "rt/pipeline/pipeline.hpp"

namespace palpate::daemon {

/// What happened, for the log.
struct EventRecord {
  std::array<char, 32> event{};
  std::array<char, 32> component{};  // the instance, "" where it is the whole
  std::array<char, 256> reason{};
};

/// Commands and targets of users: checked, carried out once however often they are sent, answered
/// by COMPONENT_EVENT. Where a key is configured, those that are not sealed with it, or come again,
/// are refused.
class Commands {
 public:
  Commands(bus::MessageBus& control, bus::MessageBus& housekeeping, std::int64_t session,
           const bus::Access& access = {});

  /// Carries out what has arrived since the last cycle.
  void handle(pipeline::Pipeline& pipeline, Replacing& replacing, std::int64_t cycle,
              std::int64_t utime) noexcept;

  /// Tells, once a second at most, that messages were refused: its own and those of `manual`.
  void announce_refused(const bus::Admission& manual, std::int64_t monotonic_ns,
                        std::int64_t utime) noexcept;
  /// Commands and targets without a valid code or with an old counter.
  std::int64_t refused() const noexcept {
    return command_admission_.refused() + target_admission_.refused();
  }

  /// Says how a replacement ended.
  void announce(const Replacing& replacing, Replacing::Outcome outcome,
                std::int64_t utime) noexcept;

  /// Announces a change of the whole's condition that nobody asked for.
  void announce(const pipeline::Condition& condition, std::int64_t utime) noexcept;

  /// The same of one component.
  void announce(const char* slot, const char* instance, const char* component, const char* event,
                const char* reason, std::int64_t utime) noexcept;
  /// Announces that messages of another type come on a channel, and of which.
  void announce_wrong_type(const bus::Subscription& channel, std::int64_t utime) noexcept;

  /// For the thread that writes the log.
  bool take_record(EventRecord& record) noexcept { return log_.pop(record); }

 private:
  void handle_command(pipeline::Pipeline& pipeline, Replacing& replacing, std::int64_t cycle,
                      std::int64_t utime) noexcept;
  void handle_target(pipeline::Pipeline& pipeline, std::int64_t utime) noexcept;
  void remember_answer(const char* event, const char* reason) noexcept;
  /// By COMPONENT_EVENT, and in the log.
  void answer(const char* slot, const char* event, std::int64_t counter, const char* reason,
              std::int64_t utime) noexcept;
  void say(const char* slot, const char* event, std::int64_t counter, const char* reason,
           std::int64_t utime) noexcept;

  bus::TypedSubscription<component_command_t> commands_;
  bus::TypedSubscription<shape_target_t> targets_;
  bus::Admission command_admission_, target_admission_;
  component_command_t command_{};
  shape_target_t target_{};
  std::int64_t last_session_ = 0;
  std::int64_t last_counter_ = -1;
  std::array<char, 32> last_answer_{};  // to the last command
  std::array<char, 256> last_reason_{};
  TargetAssembly assembly_;
  std::array<std::int64_t, 3> refused_told_{};  // commands, targets, manual forces
  std::int64_t refused_told_ns_ = 0;

  bus::Stamp stamp_;
  bus::TypedPublisher<component_event_t> events_;
  component_event_t event_{};
  boost::lockfree::spsc_queue<EventRecord, boost::lockfree::capacity<256>> log_;
};

}  // namespace palpate::daemon
