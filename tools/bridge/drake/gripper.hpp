#pragma once

#include <drake/lcmt_schunk_wsg_command.hpp>
#include <drake/lcmt_schunk_wsg_status.hpp>
#include <palpate/hand_command_t.hpp>
#include <palpate/hand_state_t.hpp>

#include "rt/bus/authentication.hpp"
#include "rt/bus/stamped_publisher.hpp"

namespace palpate::drake_bridge {

/// Drake's Schunk WSG as a hand: HAND_COMMAND to SCHUNK_WSG_COMMAND, SCHUNK_WSG_STATUS to
/// HAND_STATE. Sends nothing before the first HAND_COMMAND.
class Gripper {
 public:
  struct Options {
    std::string status = "SCHUNK_WSG_STATUS", command = "SCHUNK_WSG_COMMAND";
    double open = 0.11, closed = 0;  // m, distances of the fingers that OPEN and CLOSE request
    double force = 40;               // N, limit for OPEN and CLOSE
    double most_force = 80;          // N, largest of HOLD
    double holding_force = 2;        // N, above which closing fingers that rest hold something
  };

  Gripper(bus::MessageBus& control, bus::MessageBus& drake, const bus::Access& access,
          const Options& options);

  /// Once per cycle, after both buses have received. `utime`: us, wall clock.
  void cycle(std::int64_t utime);
  /// Commands without a valid code, or that a gripper cannot execute.
  std::int64_t rejected() const { return rejected_ + admission_.rejected(); }

 private:
  bool accept(const hand_command_t& command);
  void publish(const ::drake::lcmt_schunk_wsg_status& status, std::int64_t utime);

  Options options_;
  bus::TypedSubscription<hand_command_t> commands_;
  bus::ReplayGuard admission_;
  bus::SequenceTracker order_;
  bus::TypedSubscription<::drake::lcmt_schunk_wsg_status> statuses_;
  bus::TypedPublisher<::drake::lcmt_schunk_wsg_command> targets_;
  bus::StampedPublisher<hand_state_t> states_;
  ::drake::lcmt_schunk_wsg_command target_{};
  bool commanded_ = false, closes_ = false;
  std::int64_t sent_us_ = 0, published_us_ = 0;
  std::int64_t rejected_ = 0;
};

}  // namespace palpate::drake_bridge
