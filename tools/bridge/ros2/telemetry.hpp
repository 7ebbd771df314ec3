#pragma once

#include <memory>
#include <palpate/compensated_wrench_t.hpp>
#include <palpate/estimate_t.hpp>
#include <palpate/robot_state_t.hpp>
#include <string>

#include "participant.hpp"
#include "rt/bus/message_bus.hpp"

namespace palpate::ros2_bridge {

/// What palpated publishes in every cycle, as streams of ROS 2: the compensated wrench in S, the
/// pose of E in W, and that of the grasp in O as it is estimated. Stamps are those of palpate's
/// messages; that of the wrench is its reading's.
class Telemetry {
 public:
  struct Options {
    std::string wrench, hand_pose, grasp_pose;                                // topics; empty: none
    std::string base = "base_link", object = "object", sensor = "ft_sensor";  // names of W, O, S
  };

  Telemetry(const Participant& participant, const Options& options, bus::MessageBus& control);

  /// Passes on what has arrived.
  void cycle();

 private:
  template <class From, class To>
  struct Stream {
    Stream(const Participant& participant, const std::string& topic, bus::MessageBus& control,
           const char* channel)
        : from(control, channel, 64), to(participant, {topic, Quality::kStream}) {}
    bus::TypedSubscription<From> from;
    Writer<To> to;
  };

  Options options_;
  std::unique_ptr<Stream<compensated_wrench_t, WrenchStamped>> wrench_;
  std::unique_ptr<Stream<robot_state_t, PoseStamped>> hand_;
  std::unique_ptr<Stream<estimate_t, PoseStamped>> grasp_;
};

}  // namespace palpate::ros2_bridge
