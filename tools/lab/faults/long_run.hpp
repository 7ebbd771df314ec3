#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "rt/daemon/daemon.hpp"
#include "sim/scenes/simulation.hpp"
#include "tools/lab/faults/faulty_sensor.hpp"
#include "tools/lab/faults/faulty_wire.hpp"
#include "tools/lab/faults/monitor.hpp"
#include "tools/lab/faults/user.hpp"

namespace palpate::faults {

/// Statistics of a long run so far.
struct LongRunReport {
  double time = 0;                    // s, virtual
  std::map<std::string, int> faults;  // count of each fault
  int replaced = 0, refused = 0;      // answers to commands and targets
  int stops = 0;                      // faults after which a reset or restart was needed
  double slowest_recovery = 0;        // s from a fault's end until active
  std::vector<double> errors;         // m, of the plant's own point, before each fault
  std::int64_t messages = 0;          // published by the daemon, all of them checked
  int failures = 0;
  std::vector<std::string> complaints;  // the first failures
};

/// Simulator and daemon in a closed loop in virtual time, for hours, with one random fault after
/// another: of the network, of components, clocks and cycles, of the robot, and of the user. In
/// between the user restarts the loop and sets another target. Every number that the daemon
/// publishes must be finite, every command within the gate's limits and zero unless active, every
/// request answered, and the daemon must recover from each fault.
class LongRun {
 public:
  /// Throws config::Error.
  explicit LongRun(std::uint64_t seed);
  ~LongRun();

  /// Continues for this many s.
  void run(double seconds);
  const LongRunReport& report() const { return report_; }

 private:
  enum class Phase { kRest, kFault, kRecovery };

  void tick();
  void listen();
  void start_simulation();
  void put_target();

  void live();
  void begin_fault();
  std::string put_fault();
  void end_fault();
  void recover();
  void fail(const std::string& why);
  double time() const { return 1e-3 * static_cast<double>(tick_); }

  math::Random random_;
  LongRunReport report_;
  std::int64_t tick_ = 0;  // of 1 ms

  std::shared_ptr<bus::MemoryHub> daemon_hub_ = bus::make_memory_hub(),
                                  robot_hub_ = bus::make_memory_hub(),
                                  truth_hub_ = bus::make_memory_hub();
  std::unique_ptr<bus::MessageBus> daemon_bus_ = bus::make_memory_bus(daemon_hub_),
                                   to_daemon_ = bus::make_memory_bus(daemon_hub_),
                                   to_robot_ = bus::make_memory_bus(robot_hub_), robot_bus_,
                                   truth_bus_;
  std::unique_ptr<scenes::Simulation> simulation_;  // nullptr: not running
  std::unique_ptr<daemon::Daemon> daemon_;
  std::unique_ptr<User> user_;
  std::unique_ptr<Monitor> monitor_;
  FaultyWire wire_;
  std::vector<bus::Published> sent_, said_;
  Eigen::Vector3d rest_point_, target_;  // m, in O

  Phase phase_ = Phase::kRecovery;
  std::string fault_ = "none";
  double next_ = 0;  // s, end of the phase
  std::int64_t session_ = 0;
  FaultySensor* sensor_ = nullptr;  // in the daemon, during a component fault
  std::int64_t missed_ = 0, wakes_at_ = 0, silent_until_ = 0;  // ticks
  std::int64_t clock_offset_us_ = 0, stopped_ticks_ = 0;
  int due_answer_ = 0;  // number that must have been given when the fault ends
  bool had_to_act_ = false;
};

}  // namespace palpate::faults
