#include "gripper.hpp"

#include <cmath>
#include <palpate/channels.hpp>

namespace palpate::drake_bridge {
namespace {

constexpr std::int64_t kRepeat = 50'000;       // us: commands may be lost
constexpr std::int64_t kStatePeriod = 10'000;  // us, of HAND_STATE
constexpr double kRest = 5;                    // mm/s, below which the fingers rest
constexpr double kLeft = 1;                    // mm, of the way to `closed` with something between

}  // namespace

Gripper::Gripper(bus::MessageBus& control, bus::MessageBus& drake, const bus::Access& access,
                 const Options& options)
    : options_(options),
      commands_(control, channel::kHandCommand, 16),
      admission_(channel::kHandCommand, access),
      statuses_(drake, options.status, 16),
      targets_(drake, options.command),
      states_(control, channel::kHandState, bus::random_session()) {}

bool Gripper::accept(const hand_command_t& command) {
  if (command.action != hand_command_t::OPEN && command.action != hand_command_t::CLOSE) {
    const bool holds = command.action == hand_command_t::HOLD && command.force > 0 &&
                       command.force <= options_.most_force;
    if (!holds) return false;
  }
  closes_ = command.action != hand_command_t::OPEN;
  target_.target_position_mm = 1e3 * (closes_ ? options_.closed : options_.open);
  target_.force = command.action == hand_command_t::HOLD ? command.force : options_.force;
  commanded_ = true;
  sent_us_ = 0;
  return true;
}

void Gripper::publish(const ::drake::lcmt_schunk_wsg_status& status, std::int64_t utime) {
  if (!std::isfinite(status.actual_position_mm) || !std::isfinite(status.actual_force) ||
      !std::isfinite(status.actual_speed_mm_per_s) || utime - published_us_ < kStatePeriod)
    return;
  published_us_ = utime;
  hand_state_t state{};
  const bool holds = closes_ && std::abs(status.actual_force) >= options_.holding_force &&
                     std::abs(status.actual_speed_mm_per_s) < kRest &&
                     status.actual_position_mm > 1e3 * options_.closed + kLeft;
  state.grasp = hand_state_t::GRASP_NONE;
  if (holds) state.grasp = hand_state_t::GRASP_HOLDING;
  state.joint_count = 1;
  state.q[0] = 1e-3 * status.actual_position_mm;
  states_.publish(state, utime);
}

void Gripper::cycle(std::int64_t utime) {
  hand_command_t command;
  std::int64_t arrival_ns = 0;
  while (commands_.take(command, arrival_ns)) {
    if (admission_.judge(command) != bus::Admitted::kFresh) continue;
    if (!order_.accept(command.session, command.seq) || !accept(command)) ++rejected_;
  }
  if (commanded_ && utime - sent_us_ >= kRepeat) {
    target_.utime = sent_us_ = utime;
    targets_.publish(target_);
  }
  ::drake::lcmt_schunk_wsg_status status;
  while (statuses_.take(status, arrival_ns)) publish(status, utime);
}

}  // namespace palpate::drake_bridge
