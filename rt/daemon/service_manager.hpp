#pragma once

#include <cstdint>
#include <string>

namespace palpate::daemon {

/// The other end of systemd's notification socket (sd_notify(3), without its library). Without one
/// nothing happens.
class ServiceManager {
 public:
  /// From the variables NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID.
  ServiceManager();
  /// `socket`: path, or @name of an abstract one; empty: none. `watchdog_us` <= 0: no watchdog.
  ServiceManager(const std::string& socket, std::int64_t watchdog_us);
  ~ServiceManager();
  ServiceManager(const ServiceManager&) = delete;
  ServiceManager& operator=(const ServiceManager&) = delete;

  /// Lines such as "READY=1". Never waits; false where nobody was told.
  bool tell(const std::string& lines) noexcept;

  /// Within which it wants to hear from us again; 0: never.
  std::int64_t watchdog_ns() const noexcept { return watchdog_ns_; }

 private:
  std::string socket_;
  std::int64_t watchdog_ns_ = 0;
  int file_ = -1;
};

/// Watches, from another thread, whether the loop goes on, and tells the service manager: READY
/// after the first cycle, WATCHDOG twice in its interval as long as the loop has moved meanwhile.
class LoopWatch {
 public:
  explicit LoopWatch(ServiceManager& manager) : manager_(manager) {}

  enum class Verdict { kNothing, kStalled, kRecovered };

  /// Often; `cycles`: that the loop has done. kStalled once when it has not moved for half a
  /// second, kRecovered once when it does again.
  Verdict look(std::int64_t now_ns, std::int64_t cycles) noexcept;

  /// How the daemon does, in one line; told when it has changed.
  void set_status(const std::string& status);

 private:
  ServiceManager& manager_;
  std::string status_;
  std::int64_t cycles_ = 0;    // when last looked
  std::int64_t moved_ns_ = 0;  // when they were last seen to change
  bool stalled_ = false;
  std::int64_t pinged_cycles_ = 0;
  std::int64_t pinged_ns_ = 0;
};

}  // namespace palpate::daemon
