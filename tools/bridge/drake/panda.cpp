#include "panda.hpp"

#include <algorithm>

#include "tools/bridge/common/franka_modes.hpp"

namespace palpate::drake_bridge {
namespace {

constexpr int kVelocity = 2;  // bit of control_mode

template <class Status>
Status panda_status(int joints) {
  Status status{};
  status.num_joints = joints;
  for (auto* numbers :
       {&status.joint_position, &status.joint_position_desired, &status.joint_velocity,
        &status.joint_velocity_desired, &status.joint_acceleration_desired, &status.joint_torque,
        &status.joint_torque_desired, &status.joint_torque_external})
    numbers->resize(joints);
  return status;
}

::drake::lcmt_panda_command panda_command(int joints) {
  ::drake::lcmt_panda_command command{};
  command.num_joint_velocity = joints;
  command.joint_velocity.resize(joints);
  command.control_mode_expected = kVelocity;
  return command;
}

::drake::lcmt_panda_command_v1 former_panda_command(int joints) {
  ::drake::lcmt_panda_command_v1 command{};
  command.num_joints = joints;
  for (auto* numbers : {&command.joint_position, &command.joint_velocity, &command.joint_torque})
    numbers->resize(joints);
  command.velocity_control_expected = 1;
  return command;
}

/// `names_mode`: the driver says how it is controlled, which simulations do not.
const char* halt_of(int robot_mode, bool names_mode, bool takes_velocities) {
  if (const char* const halted = bridge::halt_of_franka(robot_mode)) return halted;
  return names_mode && !takes_velocities ? "the arm's driver is not in velocity mode" : nullptr;
}

template <class Status>
void read(const Status& status, bool external_torque, Reading& reading) {
  const auto joints = [](const std::vector<double>& numbers) {
    return Eigen::Map<const Eigen::VectorXd>(numbers.data(),
                                             static_cast<Eigen::Index>(numbers.size()));
  };
  reading.utime = status.utime;
  reading.q = joints(status.joint_position);
  reading.dq = joints(status.joint_velocity);
  reading.tau = joints(external_torque ? status.joint_torque_external : status.joint_torque);
}

}  // namespace

Panda::Panda(bus::MessageBus& bus, int joints, const std::string& status,
             const std::string& command, bool external_torque)
    : bus_(bus),
      statuses_(bus, status, panda_status<::drake::lcmt_panda_status>(joints)),
      former_statuses_(bus, status, panda_status<::drake::lcmt_panda_status_v1>(joints)),
      refusals_(
          {&statuses_.subscription(), &former_statuses_.subscription()},
          "lcmt_panda_status, present or of 2020, with " + std::to_string(joints) + " joints"),
      commands_(bus, command, panda_command(joints)),
      former_commands_(bus, command, former_panda_command(joints)),
      external_torque_(external_torque) {
  q_.setZero(joints);
}

bool Panda::take(Reading& reading) {
  if (const auto* status = statuses_.take(reading.arrival_ns)) {
    is_former_ = false;
    read(*status, external_torque_, reading);
    reading.halted = halt_of(status->robot_mode, status->control_mode != 0,
                             (status->control_mode & kVelocity) != 0);
    return true;
  }
  if (const auto* status = former_statuses_.take(reading.arrival_ns)) {
    is_former_ = true;
    read(*status, external_torque_, reading);
    const bool velocity = status->velocity_control_enabled != 0;
    const bool names_mode =
        velocity || status->position_control_enabled != 0 || status->torque_control_enabled != 0;
    reading.halted = halt_of(status->robot_mode, names_mode, velocity);
    return true;
  }
  return false;
}

bool Panda::foreign_command() {
  // Either counts the other type as foreign, also where this program has sent it.
  const bool any = commands_.any_foreign(), any_former = former_commands_.any_foreign();
  return is_former_ ? any_former : any;
}

void Panda::send(const Joints& dq, std::int64_t utime) {
  const double* const first = dq.data();
  const double* const end = first + dq.size();
  if (!is_former_) {
    std::copy(first, end, commands_.message().joint_velocity.begin());
    commands_.publish(utime);
    return;
  }
  std::copy(q_.data(), q_.data() + q_.size(), former_commands_.message().joint_position.begin());
  std::copy(first, end, former_commands_.message().joint_velocity.begin());
  former_commands_.publish(utime);
}

}  // namespace palpate::drake_bridge
