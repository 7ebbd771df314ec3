#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <palpate/component_command_t.hpp>
#include <palpate/component_event_t.hpp>
#include <palpate/feature_t.hpp>
#include <palpate/health_t.hpp>
#include <palpate/shape_target_t.hpp>
#include <palpate/twist_command_t.hpp>
#include <string>

#include "rt/bus/authentication.hpp"
#include "rt/bus/message_bus.hpp"
#include "tools/lab/runs/experiments.hpp"

namespace palpate::runs {

/// URLs of one run, with ports that nothing else on this machine uses.
struct Urls {
  std::string control;
  std::string housekeeping;
  std::string pictures;
};
Urls private_urls();

/// Operator of a running daemon: starts it, sets targets, reads its health.
class Operator {
 public:
  /// `key`: configured in the daemon. Throws std::runtime_error if a URL cannot be opened.
  explicit Operator(const Urls& urls, const std::optional<bus::Key>& key = {});

  /// Handles arriving messages for `seconds` and repeats the target at 2 Hz; throws Interrupted.
  void spin(double seconds);

  /// Sends an event to all slots once.
  void send_event(const std::string& event);

  void set_target(const ControlTarget& target);

  bool heard() const { return health_.has_value(); }
  const std::optional<health_t>& health() const { return health_; }
  bool is_running() const;  // active or degraded
  bool is_active() const;
  bool has_robot_state() const;
  /// Reason why the daemon rejected the last command or target; empty if it did not.
  const std::string& refusal() const { return refusal_; }

  /// s for which the daemon has followed our target and commanded no motion.
  double settled() const;
  /// m, distance of the estimated feature to the target; negative if unknown.
  double estimated_error() const { return estimated_error_; }

 private:
  void take_all();
  void take(const component_event_t& event);
  void take(const feature_t& feature);
  void take(const twist_command_t& command);

  std::unique_ptr<bus::MessageBus> control_, housekeeping_;
  bus::TypedSubscription<health_t> healths_;
  bus::TypedSubscription<component_event_t> events_;
  bus::TypedSubscription<feature_t> features_;
  bus::TypedSubscription<twist_command_t> twists_;
  bus::TypedPublisher<component_command_t> commands_;
  bus::TypedPublisher<shape_target_t> targets_;
  std::int64_t session_;
  std::int32_t seq_ = 0;
  bus::MessageSigner command_sealer_, target_sealer_;
  std::optional<shape_target_t> target_;
  std::int64_t target_sent_ = 0;  // us
  std::optional<health_t> health_;
  std::string refusal_;
  bool following_ = false;
  std::int64_t still_since_ = 0;  // us; 0: moving
  double estimated_error_ = -1;
};

/// us since the epoch.
std::int64_t wall_clock();

}  // namespace palpate::runs
