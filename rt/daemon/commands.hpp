#pragma once

#include <array>
#include <boost/lockfree/spsc_queue.hpp>
#include <palpate/component_command_t.hpp>
#include <palpate/component_event_t.hpp>
#include <palpate/shape_target_t.hpp>

#include "rt/bus/authentication.hpp"
#include "rt/bus/stamped_publisher.hpp"
#include "rt/daemon/inputs.hpp"
#include "rt/daemon/replacing.hpp"
#include "rt/daemon/target_assembly.hpp"
#include "rt/pipeline/pipeline.hpp"

namespace palpate::daemon {

/// Life-cycle event for the log.
struct EventRecord {
  std::array<char, 32> event{};
  std::array<char, 32> component{};  // the instance; "" for the whole pipeline
  std::array<char, 256> reason{};
};

/// Commands and targets of users: validated, executed once however often they are repeated,
/// acknowledged by COMPONENT_EVENT. With a configured key, unsigned and replayed commands are
/// rejected.
class Commands {
 public:
  Commands(bus::MessageBus& control, bus::MessageBus& housekeeping, std::int64_t session,
           const bus::Access& access = {});

  /// Executes the commands received since the last cycle.
  void handle(pipeline::Pipeline& pipeline, Replacing& replacing, std::int64_t cycle,
              std::int64_t utime) noexcept;

  /// Admission of the other signed channels: manual forces, obstacles, guarded motions.
  using Admissions = const bus::ReplayGuard* const (&)[3];
  /// Reports, at most once per second, that messages of those or commands were rejected.
  void announce_rejected(Admissions others, std::int64_t monotonic_ns, std::int64_t utime) noexcept;
  /// Number of commands and targets without a valid code or with an old counter.
  std::int64_t rejected() const noexcept {
    return command_admission_.rejected() + target_admission_.rejected();
  }

  /// Publishes the outcome of a replacement.
  void announce(const Replacing& replacing, Replacing::Outcome outcome,
                std::int64_t utime) noexcept;

  /// Publishes a change of the pipeline's state that was not commanded.
  void announce(const pipeline::Condition& condition, std::int64_t utime) noexcept;

  /// The same for one component.
  void announce(const char* slot, const char* instance, const char* component, const char* event,
                const char* reason, std::int64_t utime) noexcept;
  /// Publishes that messages of a different type arrive on a channel, and their type.
  void announce_wrong_type(const bus::Subscription& channel, std::int64_t utime) noexcept;

  /// Called by the thread that writes the log.
  bool take_record(EventRecord& record) noexcept { return log_.pop(record); }

 private:
  void handle_command(pipeline::Pipeline& pipeline, Replacing& replacing, std::int64_t cycle,
                      std::int64_t utime) noexcept;
  void handle_target(pipeline::Pipeline& pipeline, std::int64_t utime) noexcept;
  void remember_answer(const char* event, const char* reason) noexcept;
  /// Publishes COMPONENT_EVENT and adds a log entry.
  void answer(const char* slot, const char* event, std::int64_t counter, const char* reason,
              std::int64_t utime) noexcept;
  void say(const char* slot, const char* event, std::int64_t counter, const char* reason,
           std::int64_t utime) noexcept;

  bus::TypedSubscription<component_command_t> commands_;
  bus::TypedSubscription<shape_target_t> targets_;
  bus::ReplayGuard command_admission_, target_admission_;
  component_command_t command_{};
  shape_target_t target_{};
  std::int64_t last_session_ = 0;
  std::int64_t last_counter_ = -1;
  std::array<char, 32> last_answer_{};  // to the last command
  std::array<char, 256> last_reason_{};
  TargetAssembly assembly_;
  std::array<std::int64_t, 5> rejected_reported_{};  // for commands, targets, the others
  std::int64_t rejected_reported_ns_ = 0;

  bus::StampedPublisher<component_event_t> events_;
  component_event_t event_{};
  boost::lockfree::spsc_queue<EventRecord, boost::lockfree::capacity<256>> log_;
};

}  // namespace palpate::daemon
