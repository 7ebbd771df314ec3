#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "rt/daemon/daemon.hpp"
#include "tools/lab/faults/monitor.hpp"
#include "tools/lab/faults/recording.hpp"

namespace palpate::faults {

/// Output of a daemon in one cycle of 1 ms.
struct Cycle {
  pipeline::LifeCycle state = pipeline::LifeCycle::kInactive;
  bool command_valid = false;
  double speed = 0;                // of the command, m/s
  std::uint64_t hash = 0;          // of its output, except contacts, HEALTH and events
  std::uint64_t contact_hash = 0;  // of CONTACTS
  math::Vector6d wrench = math::Vector6d::Zero();  // of the first contact, N and N m
};

/// Output of a daemon over a stream, by cycle: index 0 is 1 ms.
struct Trace {
  std::vector<Cycle> cycles;
  std::vector<double> shape_error;  // m, RMS over nodes, every kTruthEvery ms; empty: another mesh
  std::vector<HealthNote> health;
  std::vector<EventNote> events;
  int not_finite = 0, beyond_limits = 0, undecoded = 0;
  std::string complaint;  // the first of these
  double largest_step = 0;

  bool sound() const { return not_finite + beyond_limits + undecoded == 0; }
};

/// Passes the messages that a daemon has published in a cycle to the monitor.
void look_at(const std::vector<bus::Published>& said, daemon::Daemon& daemon, Monitor& monitor);

/// A daemon that receives a stream of messages in virtual time, with a user who starts it and sets
/// a target, and a record of everything that it publishes.
class Replay {
 public:
  /// Throws config::Error.
  explicit Replay(const Recording& recording, const std::vector<std::string>& overrides = {},
                  daemon::Mode mode = daemon::Mode::kDeterministic);

  /// Called before each cycle, whose time it may change; false: the loop skips this one.
  using Each = std::function<bool(int tick, daemon::Now& now)>;
  /// Call once per object.
  Trace run(const Stream& stream, int ticks, const Each& each = {});

  daemon::Daemon& daemon() { return *daemon_; }
  client::Client& user() { return user_; }

 private:
  void observe(int tick, Trace& trace);

  const Recording& recording_;
  std::shared_ptr<bus::MemoryHub> hub_ = bus::make_memory_hub();
  std::unique_ptr<bus::MessageBus> daemon_bus_ = bus::make_memory_bus(hub_);
  std::unique_ptr<bus::MessageBus> outside_ = bus::make_memory_bus(hub_);
  std::unique_ptr<daemon::Daemon> daemon_;
  client::Client user_{*outside_, *outside_, {}, 1};
  std::unique_ptr<Monitor> monitor_;
  std::vector<bus::Published> said_;
};

}  // namespace palpate::faults
