#pragma once

#include <memory>
#include <vector>

#include "rt/client/client.hpp"
#include "rt/daemon/daemon.hpp"
#include "sim/scenes/simulation.hpp"
#include "tools/lab/faults/faulty_wire.hpp"

namespace palpate::faults {

/// Simulator, daemon and user in a closed loop in virtual time, in ticks of 1 ms, with a faulty
/// network between simulator and daemon. Each tick: advance(), then step().
class VirtualLoop {
 public:
  /// Throws config::Error.
  explicit VirtualLoop(const config::Node& root);

  void advance();
  /// Steps the simulator and runs the daemon's cycle. False if the daemon misses this cycle.
  bool step();
  double time() const { return 1e-3 * static_cast<double>(tick_); }  // s

  daemon::Daemon& daemon() { return *daemon_; }
  client::Client& user() { return user_; }
  FaultyWire& wire() { return wire_; }
  /// Messages of the daemon in its last cycle.
  const std::vector<bus::Published>& published() const { return published_; }
  const scenes::Simulation* simulation() const { return simulation_.get(); }  // nullptr: ended

  void start_simulation();
  void end_simulation() { simulation_.reset(); }
  /// The daemon misses the cycles of the next `ticks`.
  void suspend_daemon(std::int64_t ticks) { wakes_at_ = tick_ + ticks; }
  /// The robot receives no commands in the next `ticks`.
  void lose_commands(std::int64_t ticks) { silent_until_ = tick_ + ticks; }
  void shift_daemon_clock(std::int64_t us) { clock_offset_us_ += us; }

 private:
  std::int64_t tick_ = 0;
  std::shared_ptr<bus::MemoryHub> daemon_hub_ = bus::make_memory_hub(),
                                  robot_hub_ = bus::make_memory_hub(),
                                  truth_hub_ = bus::make_memory_hub();
  std::unique_ptr<bus::MessageBus> daemon_bus_ = bus::make_memory_bus(daemon_hub_),
                                   to_daemon_ = bus::make_memory_bus(daemon_hub_),
                                   to_robot_ = bus::make_memory_bus(robot_hub_), robot_bus_,
                                   truth_bus_;
  std::unique_ptr<scenes::Simulation> simulation_;
  std::unique_ptr<daemon::Daemon> daemon_;
  client::Client user_{*to_daemon_, *to_daemon_, {}, 1};
  FaultyWire wire_;
  std::vector<bus::Published> sent_, published_;               // by the simulator, by the daemon
  std::int64_t session_ = 0;                                   // of the simulator
  std::int64_t missed_ = 0, wakes_at_ = 0, silent_until_ = 0;  // ticks
  std::int64_t clock_offset_us_ = 0;
};

}  // namespace palpate::faults
