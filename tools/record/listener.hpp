#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "rt/bus/message_bus.hpp"
#include "rt/bus/udpm_url.hpp"

namespace palpate::record {

/// An LCM URL with the name that users know it by.
struct Source {
  std::string label;  // control, housekeeping, pictures
  bus::UdpmUrl url;
};

/// The daemon's defaults: control, housekeeping and pictures.
std::vector<Source> default_sources();

/// Puts each "[LABEL=]URL", without a label that of control, in the place of the default of its
/// label, or behind all. Throws std::invalid_argument for a label that is not [a-z0-9_]+ or a URL
/// that is wrong.
void put_urls(const std::vector<std::string>& texts, std::vector<Source>& sources);

/// A message as it came; valid within the handler.
struct Heard {
  int source = 0;               // index of its URL
  std::int64_t utime = 0;       // us of the wall clock at the start plus what has passed since: one
                                // axis for all URLs, without jumps
  std::int64_t arrival_ns = 0;  // CLOCK_MONOTONIC
  std::string_view channel;     // 1 to 63 printable characters
  const std::uint8_t* data = nullptr;
  int size = 0;  // of the data, bytes
};

/// Hears every channel of several LCM URLs. Takes whole short messages alone, by the same framing
/// as the daemon's receiver, and counts all else: no datagram can make it allocate, throw, or read
/// outside of what was received.
class Listener {
 public:
  using Handler = std::function<void(const Heard&)>;

  /// Joins the groups. Throws std::runtime_error with the remedy where that fails. The handler is
  /// called by whoever receives.
  Listener(std::vector<Source> sources, Handler handler);
  ~Listener();
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  /// From now on a thread receives.
  void start();
  /// Ends the thread; what lies in the sockets by then is handed on first.
  void stop() noexcept;
  /// In place of start(): hands on some of what has come, after waiting at most `timeout_ms` (-1:
  /// for ever). False where nothing has.
  bool receive(int timeout_ms);

  const std::vector<Source>& sources() const noexcept { return sources_; }
  const bus::DatagramCounters& datagrams(int source) const noexcept;
  /// Bytes that the system gave the socket for its queue.
  int receive_buffer_size(int source) const noexcept;

 private:
  struct Group;

  bool receive_one(int source);
  void handle(int source, const std::uint8_t* data, int size);

  std::vector<Source> sources_;
  Handler handler_;
  std::vector<std::unique_ptr<Group>> groups_;
  int wake_ = -1;
  std::int64_t wall_us_, monotonic_ns_;  // at the start
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace palpate::record
