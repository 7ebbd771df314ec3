#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <regex>
#include <string>
#include <string_view>
#include <thread>
#include <unordered_map>
#include <vector>

#include "rt/bus/message_bus.hpp"
#include "rt/bus/udpm_url.hpp"

namespace CLI {
class App;
}  // namespace CLI

namespace palpate::record {

/// Selection of channels: those whose whole name matches a regular expression, or all others.
class ChannelFilter {
 public:
  /// Throws std::invalid_argument if `pattern` is not a regular expression (ECMAScript).
  explicit ChannelFilter(const std::string& pattern = ".*", bool invert = false);

  bool wants(std::string_view channel);

 private:
  std::regex pattern_;
  bool all_, invert_;
  std::unordered_map<std::string, bool> known_;  // cached answers
};

/// Default bound of a message of several fragments, bytes: a point cloud of 640 x 480 points
/// has 3.7 MB.
inline constexpr int kLargestMessage = 8'000'000;

/// An LCM URL with its label for the user.
struct Source {
  std::string label;  // control, housekeeping, pictures
  bus::UdpmUrl url;
};

/// The daemon's defaults: control, housekeeping and pictures.
std::vector<Source> default_sources();

/// Replaces the default of each label in "LABEL=URL", or appends it. Throws std::invalid_argument
/// for a label that is not [a-z0-9_]+ or an invalid URL.
void put_urls(const std::vector<std::string>& texts, std::vector<Source>& sources);

/// --url [LABEL=]URL, repeatable, for put_urls().
void add_url_option(CLI::App& app, std::vector<std::string>& urls);

/// A received message; valid within the handler.
struct Heard {
  int source = 0;          // index of its URL
  std::int64_t utime = 0;  // us of the wall clock at the start plus the elapsed time: one axis for
                           // all URLs, without jumps
  std::int64_t arrival_ns = 0;  // CLOCK_MONOTONIC
  std::string_view channel;     // 1 to 63 printable characters
  const std::uint8_t* data = nullptr;
  int size = 0;  // of the data, bytes
};

/// Receives every channel of several LCM URLs. Accepts short messages, and larger ones of several
/// fragments up to a bound, with the same framing as the daemon's receiver, and counts everything
/// else: no datagram can make it allocate, throw, or read outside the received data.
class Listener {
 public:
  using Handler = std::function<void(const Heard&)>;

  /// Joins the groups. `largest`: size of a message of several fragments, bytes; 0: fragments are
  /// dropped. Throws std::runtime_error with the remedy on failure. The handler is called in the
  /// receiving thread.
  Listener(std::vector<Source> sources, Handler handler, int largest = 0);
  ~Listener();
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  /// Starts a receiving thread.
  void start();
  /// Ends the thread; data in the sockets at that time are passed on first.
  void stop() noexcept;
  /// Alternative to start(): passes on some of the received messages, after waiting at most
  /// `timeout_ms` (-1: for ever). False if there are none.
  bool receive(int timeout_ms);

  const std::vector<Source>& sources() const noexcept { return sources_; }
  const bus::DatagramCounters& datagrams(int source) const noexcept;
  /// Size in bytes of the socket's queue as granted by the system.
  int receive_buffer_size(int source) const noexcept;

 private:
  struct Group;

  bool receive_one(int source);
  void handle(int source, const std::uint8_t* data, int size, std::uint64_t sender);

  std::vector<Source> sources_;
  Handler handler_;
  std::vector<std::unique_ptr<Group>> groups_;
  int wake_ = -1;
  std::int64_t wall_us_, monotonic_ns_;  // at the start
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace palpate::record
