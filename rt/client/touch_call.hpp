#pragma once

#include <cstdint>
#include <optional>
#include <palpate/touch_request_t.hpp>
#include <palpate/touch_t.hpp>

#include "rt/bus/message_bus.hpp"
#include "rt/bus/session.hpp"
#include "rt/client/outgoing.hpp"

namespace palpate::client {

/// Whether the motion has ended, or was refused.
bool is_final(const touch_t& touch) noexcept;
/// WAITING, APPROACHING, ... in lower case, for people.
const char* name_of_state(const touch_t& touch) noexcept;

/// One guarded motion of a running daemon: requests it, repeats what UDP may lose, and follows it.
/// Use from one thread; `now_us` is the wall clock.
class TouchCall {
 public:
  /// The bus must outlive the call, and be started by the caller afterwards. `session`: fixed in
  /// deterministic runs.
  explicit TouchCall(bus::MessageBus& control, const bus::Access& access = {},
                     std::int64_t session = bus::random_session());

  /// Sends a request with direction, force, speed, distance and retreat of `request`.
  void begin(const touch_request_t& request, std::int64_t now_us);
  /// Asks the daemon to stop; service() repeats it until the motion has ended.
  void cancel(std::int64_t now_us);
  /// Handles what has arrived and repeats what is due; call several times per second.
  void service(std::int64_t now_us);

  /// The last TOUCH of this motion; empty before the first one.
  const std::optional<touch_t>& latest() const { return latest_; }
  bool has_ended() const { return latest_ && is_final(*latest_); }
  /// us since the last TOUCH of this motion, or since begin().
  std::int64_t silence(std::int64_t now_us) const { return now_us - heard_us_; }

 private:
  void send(std::int64_t now_us);

  bus::MessageBus& control_;
  bus::TypedSubscription<touch_t> touches_;
  Outgoing<touch_request_t> requests_;
  touch_request_t request_{};
  std::optional<touch_t> latest_;
  std::int64_t sent_us_ = 0, heard_us_ = 0;
};

}  // namespace palpate::client
