#include "rt/daemon/service_manager.hpp"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstddef>
#include <cstdlib>
#include <cstring>

namespace palpate::daemon {
namespace {

constexpr std::int64_t kStalledAfter = 500'000'000;  // ns

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr ? value : "";
}

/// Only if intended for this process rather than its parent.
std::int64_t watchdog_us() {
  const std::string process = variable("WATCHDOG_PID");
  if (!process.empty() && process != std::to_string(getpid())) return 0;
  return std::strtoll(variable("WATCHDOG_USEC").c_str(), nullptr, 10);
}

}  // namespace

ServiceManager::ServiceManager() : ServiceManager(variable("NOTIFY_SOCKET"), watchdog_us()) {}

ServiceManager::ServiceManager(const std::string& socket, std::int64_t watchdog_us)
    : socket_(socket) {
  if (socket_.empty() || socket_.size() >= sizeof(sockaddr_un::sun_path)) return;
  if (watchdog_us > 0) watchdog_ns_ = watchdog_us * 1000;
  file_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
}

ServiceManager::~ServiceManager() {
  if (file_ >= 0) close(file_);
}

bool ServiceManager::notify(const std::string& lines) noexcept {
  if (file_ < 0) return false;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, socket_.data(), socket_.size());
  if (socket_[0] == '@') address.sun_path[0] = '\0';
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + socket_.size());
  return sendto(file_, lines.data(), lines.size(), MSG_NOSIGNAL | MSG_DONTWAIT,
                reinterpret_cast<const sockaddr*>(&address),
                size) == static_cast<ssize_t>(lines.size());
}

LoopWatch::Verdict LoopWatch::look(std::int64_t now_ns, std::int64_t cycles) noexcept {
  const bool first = cycles_ == 0;
  if (cycles != cycles_ || moved_ns_ == 0) moved_ns_ = now_ns;
  cycles_ = cycles;
  if (cycles == 0) return Verdict::kNothing;
  if (first) manager_.notify("READY=1");
  if (manager_.watchdog_ns() > 0 && cycles != pinged_cycles_ &&
      now_ns - pinged_ns_ >= manager_.watchdog_ns() / 2) {
    manager_.notify("WATCHDOG=1");
    pinged_cycles_ = cycles;
    pinged_ns_ = now_ns;
  }
  const bool stalled = now_ns - moved_ns_ >= kStalledAfter;
  if (stalled == stalled_) return Verdict::kNothing;
  stalled_ = stalled;
  return stalled ? Verdict::kStalled : Verdict::kRecovered;
}

void LoopWatch::set_status(const std::string& status) {
  if (status == status_) return;
  status_ = status;
  manager_.notify("STATUS=" + status);
}

}  // namespace palpate::daemon
