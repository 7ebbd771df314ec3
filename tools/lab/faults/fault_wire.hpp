#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string_view>
#include <thread>
#include <vector>

#include "rt/bus/lcm_bus.hpp"
#include "tools/lab/faults/scenario.hpp"
#include "tools/lab/runs/live_run.hpp"

namespace palpate::faults {

/// Simulates everything around a daemon's process: sends a scenario's messages at their times and
/// records everything that the daemon publishes, from a separate thread. Times in ns since the
/// scenario's start.
class FaultWire {
 public:
  /// Throws std::runtime_error if a URL cannot be opened.
  explicit FaultWire(const runs::Urls& urls);
  ~FaultWire();
  FaultWire(const FaultWire&) = delete;
  FaultWire& operator=(const FaultWire&) = delete;

  /// Whether the daemon has published anything yet.
  bool heard() const { return heard_any_; }

  /// From now on received messages are kept, with times since now. play() calls it itself.
  void begin();
  /// s since then.
  double now() const;

  /// Sends the whole scenario, with start and target as in virtual time. `each`: called every
  /// millisecond. Throws Interrupted.
  void play(const faults::Recording& recording, const faults::Scenario& scenario,
            const std::function<void(int tick)>& each);
  /// s, largest delay of a sent message that this machine caused.
  double latest() const { return latest_; }
  /// s between the last two commands of the daemon, by its own clock; after trace().
  double last_gap() const { return last_gap_; }

  /// The received messages as a run in virtual time would give them; ends the recording. `limits`:
  /// of the gate; commands every `period` s. The flange pose is unknown, so that the workspace is
  /// not checked.
  faults::Trace trace(int ticks, const control::GateLimits& limits, double period);

 private:
  /// Of the daemon. `decodes`: whether bytes are one whole message of the channel's type.
  struct Channel {
    std::string_view name;
    bool (*decodes)(const void* data, int size);
  };
  /// One URL and what is kept of it.
  struct Ear {
    std::vector<Channel> channels;
    bus::UdpmSocket socket;
    bus::DatagramCounters counters;
  };
  void open(Ear& ear, const std::string& url);
  void listen();
  void take_waiting(Ear& ear);

  std::unique_ptr<bus::MessageBus> sender_;
  client::Client user_;
  Ear control_, housekeeping_;
  std::vector<bus::Published> heard_;
  int undecoded_ = 0;  // on a channel of the daemon, of another type or size
  std::atomic<bool> heard_any_{false};
  std::atomic<std::int64_t> origin_us_{
      0};  // of the wall clock, by which the system stamps arrivals
  double latest_ = 0, last_gap_ = 0;
  std::atomic<bool> stop_{false};
  std::thread listener_;
};

}  // namespace palpate::faults
