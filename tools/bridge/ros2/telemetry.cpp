#include "telemetry.hpp"

#include <palpate/channels.hpp>

#include "conversions.hpp"

namespace palpate::ros2_bridge {

Telemetry::Telemetry(const Participant& participant, const Options& options,
                     bus::MessageBus& control)
    : options_(options) {
  const auto make = [&](auto& stream, const std::string& topic, const char* channel) {
    using Kind = typename std::decay_t<decltype(stream)>::element_type;
    if (!topic.empty()) stream = std::make_unique<Kind>(participant, topic, control, channel);
  };
  make(wrench_, options.wrench, channel::kWrenchCompensated);
  make(hand_, options.hand_pose, channel::kRobotState);
  make(grasp_, options.grasp_pose, channel::kEstimate);
}

void Telemetry::cycle() {
  std::int64_t arrival_ns = 0;
  for (compensated_wrench_t from; wrench_ && wrench_->from.take(from, arrival_ns);) {
    if (from.valid != 1) continue;
    const double* const w = from.wrench_s;
    WrenchStamped to{};
    to.header = {stamp_of(from.reading_utime > 0 ? from.reading_utime : from.utime),
                 options_.sensor.data()};
    to.wrench = {{w[0], w[1], w[2]}, {w[3], w[4], w[5]}};
    wrench_->to.write(to);
  }
  for (robot_state_t from; hand_ && hand_->from.take(from, arrival_ns);) {
    PoseStamped to{};
    to.header = {stamp_of(from.utime), options_.base.data()};
    to.pose = pose_message(from.position, from.quaternion);
    hand_->to.write(to);
  }
  for (estimate_t from; grasp_ && grasp_->from.take(from, arrival_ns);) {
    if (from.grasp_count < 1 || from.status == estimate_t::STATUS_FAULT) continue;
    PoseStamped to{};
    to.header = {stamp_of(from.utime), options_.object.data()};
    to.pose = pose_message(from.grasp_position[0], from.grasp_quaternion[0]);
    grasp_->to.write(to);
  }
}

}  // namespace palpate::ros2_bridge
