#pragma once

#include <palpate/touch_request_t.hpp>
#include <palpate/touch_t.hpp>

#include "rt/bus/authentication.hpp"
#include "rt/bus/message_bus.hpp"
#include "rt/bus/stamped_publisher.hpp"
#include "rt/pipeline/pipeline.hpp"

namespace palpate::daemon {

/// Guarded motions on request: receives TOUCH_REQUEST, begins each motion once however often its
/// request is repeated, and publishes TOUCH. Nothing allocates after construction.
class Touching {
 public:
  Touching(bus::MessageBus& control, std::int64_t session, const bus::Access& access = {});

  /// Each cycle, before the phases of the pipeline.
  void handle(pipeline::Pipeline& pipeline, std::int64_t utime) noexcept;
  /// Each cycle, after them: at 20 Hz while a motion runs and for one second after its end.
  void publish(const pipeline::Pipeline& pipeline, std::int64_t monotonic_ns,
               std::int64_t utime) noexcept;

  /// Requests without a valid code or with an old counter.
  const bus::ReplayGuard& admission() const noexcept { return admission_; }

 private:
  void begin(pipeline::Pipeline& pipeline, std::int64_t utime) noexcept;
  void refuse(const char* reason, std::int64_t utime) noexcept;
  void put(const control::TouchReport* report) noexcept;

  bus::TypedSubscription<touch_request_t> requests_;
  bus::ReplayGuard admission_;
  touch_request_t request_{};
  bus::StampedPublisher<touch_t> publisher_;
  touch_t message_{};                             // of the last motion that began
  touch_t refusal_{};                             // of the last one that did not
  std::int64_t sender_ = 0, refused_sender_ = 0;  // sessions of those requests
  std::int64_t published_ns_ = 0;                 // 0: publish in this cycle
  std::int64_t ended_ns_ = 0;                     // 0: the motion runs
};

}  // namespace palpate::daemon
