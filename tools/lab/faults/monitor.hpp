#pragma once

#include <optional>
#include <palpate/component_event_t.hpp>
#include <palpate/health_t.hpp>
#include <string>
#include <vector>

#include "core/control/safety_gate.hpp"
#include "rt/bus/message_bus.hpp"

namespace palpate::faults {

/// The counters of HEALTH in which a fault may show; sums over all inputs.
struct HealthNote {
  std::int64_t time_ns = 0;
  int state = 0;
  std::int64_t lost = 0, rejected = 0, frozen = 0;
  std::int64_t not_converged = 0, gate_rejected = 0, overruns = 0;
  double oldest_ms = 0;  // of force-torque, inertial and robot
  double hand_ms = 0;
};

struct EventNote {
  std::int64_t time_ns = 0;
  std::string slot, event, reason;
};

/// Reads everything that a daemon publishes: every number of every message must be finite and every
/// command within the gate's limits.
class Monitor {
 public:
  Monitor(const control::GateLimits& limits, double period) : limits_(limits), period_(period) {}

  /// `pose_E`: flange pose in the last valid robot state; empty if unknown. `restrained`: the gate
  /// brakes, since it is inactive or rejects requests; empty: unknown from outside, so that any
  /// command that does not increase is accepted as braking.
  void look(const bus::Published& message, const std::optional<Eigen::Vector3d>& p_W_E,
            std::optional<bool> restrained);

  int messages() const { return messages_; }
  int undecoded() const { return undecoded_; }  // or on an unexpected channel
  int not_finite() const { return not_finite_; }
  int beyond_limits() const { return beyond_limits_; }
  const std::string& complaint() const { return complaint_; }  // the first
  double speed() const { return last_linear_.norm(); }         // of the last command, m/s
  bool command_valid() const { return command_valid_; }
  /// Change of the last command relative to the change that the gate allows while following a
  /// request.
  double largest_step() const { return largest_step_; }

  /// Hash of the loop's output since the last call, without headers: shape, estimate, feature,
  /// commands; and with the contacts.
  std::uint64_t take_hash();
  std::uint64_t take_contact_hash();

  const std::vector<HealthNote>& health() const { return health_; }
  const std::vector<EventNote>& events() const { return events_; }
  /// For an endless run: discards the notes and complaints so far.
  void forget() {
    health_.clear();
    events_.clear();
    undecoded_ = not_finite_ = beyond_limits_ = 0;
    complaint_.clear();
  }

 private:
  template <class Message>
  bool read(const bus::Published& message, Message& into);
  void complain(int& counter, const std::string& what);
  void look_at_command(const bus::Published& message, const std::optional<Eigen::Vector3d>& p_W_E,
                       std::optional<bool> restrained);
  void look_at_health(const bus::Published& message);

  control::GateLimits limits_;
  double period_;
  int messages_ = 0, undecoded_ = 0, not_finite_ = 0, beyond_limits_ = 0;
  std::string complaint_;
  Eigen::Vector3d last_linear_ = Eigen::Vector3d::Zero(), last_angular_ = Eigen::Vector3d::Zero();
  bool command_valid_ = false;
  std::int32_t last_seq_ = 0;
  double largest_step_ = 0;
  std::uint64_t hash_ = 0, contact_hash_ = 0;
  std::vector<HealthNote> health_;
  std::vector<EventNote> events_;
};

}  // namespace palpate::faults
