#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tools/lab/faults/faulty_sensor.hpp"
#include "tools/lab/faults/monitor.hpp"
#include "tools/lab/faults/virtual_loop.hpp"

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

  /// Continues for this many s.
  void run(double seconds);
  const LongRunReport& report() const { return report_; }

 private:
  LongRun(std::uint64_t seed, const config::Node& root);
  enum class Phase { kRest, kFault, kRecovery };

  void tick();
  void inspect();
  void put_target();

  void live();
  void begin_fault();
  std::string put_fault();
  void end_fault();
  void recover();
  void fail(const std::string& why);
  double time() const { return loop_.time(); }

  math::Random random_;
  LongRunReport report_;
  VirtualLoop loop_;
  Monitor monitor_;
  const Eigen::Vector3d rest_point_;  // m, in O
  Eigen::Vector3d target_ = rest_point_;

  Phase phase_ = Phase::kRecovery;
  std::string fault_ = "none";
  double next_ = 0;                 // s, end of the phase
  FaultySensor* sensor_ = nullptr;  // in the daemon, during a component fault
  std::int64_t stopped_ticks_ = 0;
  int due_answer_ = 0;  // number that must have been given when the fault ends
  bool had_to_act_ = false;
};

}  // namespace palpate::faults
