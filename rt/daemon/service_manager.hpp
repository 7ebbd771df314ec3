#pragma once

#include <cstdint>
#include <string>

namespace palpate::daemon {

/// Client of systemd's notification socket (sd_notify(3), without its library). No effect without a
/// socket.
class ServiceManager {
 public:
  /// Uses the variables NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID.
  ServiceManager();
  /// `socket`: path, or @name of an abstract one; empty: none. `watchdog_us` <= 0: no watchdog.
  ServiceManager(const std::string& socket, std::int64_t watchdog_us);
  ~ServiceManager();
  ServiceManager(const ServiceManager&) = delete;
  ServiceManager& operator=(const ServiceManager&) = delete;

  /// Sends lines such as "READY=1". Never waits; false if they were not sent.
  bool notify(const std::string& lines) noexcept;

  /// Watchdog interval of the service manager; 0: disabled.
  std::int64_t watchdog_ns() const noexcept { return watchdog_ns_; }

 private:
  std::string socket_;
  std::int64_t watchdog_ns_ = 0;
  int file_ = -1;
};

/// Monitors the progress of the loop from another thread and notifies the service manager: READY
/// after the first cycle, WATCHDOG twice per interval as long as the loop advances.
class LoopWatch {
 public:
  explicit LoopWatch(ServiceManager& manager) : manager_(manager) {}

  enum class Verdict { kNothing, kStalled, kRecovered };

  /// Call frequently; `cycles`: count of the loop. Returns kStalled once if it has not advanced for
  /// half a second, kRecovered once when it advances again.
  Verdict look(std::int64_t now_ns, std::int64_t cycles) noexcept;

  /// Status of the daemon in one line; sent when it changes.
  void set_status(const std::string& status);

 private:
  ServiceManager& manager_;
  std::string status_;
  std::int64_t cycles_ = 0;    // at the last call of look()
  std::int64_t moved_ns_ = 0;  // time of their last change
  bool stalled_ = false;
  std::int64_t pinged_cycles_ = 0;
  std::int64_t pinged_ns_ = 0;
};

}  // namespace palpate::daemon
