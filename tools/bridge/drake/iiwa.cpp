#include "iiwa.hpp"

#include <algorithm>

namespace palpate::drake_bridge {
namespace {

constexpr double kLag = 0.1;     // s, that a moving arm may be late
constexpr double kMemory = 0.3;  // s, within which it makes up for that after it has slowed down

::drake::lcmt_iiwa_status iiwa_status(int joints) {
  ::drake::lcmt_iiwa_status status{};
  status.num_joints = joints;
  for (auto* numbers :
       {&status.joint_position_measured, &status.joint_velocity_estimated,
        &status.joint_position_commanded, &status.joint_position_ipo, &status.joint_torque_measured,
        &status.joint_torque_commanded, &status.joint_torque_external})
    numbers->resize(joints);
  return status;
}

::drake::lcmt_iiwa_command iiwa_command(int joints) {
  ::drake::lcmt_iiwa_command command{};
  command.num_joints = joints;
  command.joint_position.resize(joints);
  return command;
}

}  // namespace

Iiwa::Iiwa(bus::MessageBus& bus, const kinematics::SerialChain& chain, const std::string& status,
           const std::string& command, double follow, bool external_torque)
    : bus_(bus),
      statuses_(bus, status, iiwa_status(chain.joint_count())),
      refusals_({&statuses_.subscription()},
                "lcmt_iiwa_status with " + std::to_string(chain.joint_count()) + " joints"),
      commands_(bus, command, iiwa_command(chain.joint_count())),
      follow_(follow),
      external_torque_(external_torque),
      lower_(chain.joint_count()),
      upper_(chain.joint_count()) {
  for (int i = 0; i < chain.joint_count(); ++i) {
    lower_[i] = chain.joint(i).lower;
    upper_[i] = chain.joint(i).upper;
  }
  begin(Joints::Zero(chain.joint_count()));
}

bool Iiwa::take(Reading& reading) {
  const ::drake::lcmt_iiwa_status* status = statuses_.take(reading.arrival_ns);
  if (status == nullptr) return false;
  const auto joints = [](const std::vector<double>& numbers) {
    return Eigen::Map<const Eigen::VectorXd>(numbers.data(),
                                             static_cast<Eigen::Index>(numbers.size()));
  };
  reading.utime = status->utime;
  reading.q = joints(status->joint_position_measured);
  reading.dq = joints(status->joint_velocity_estimated);
  reading.tau =
      joints(external_torque_ ? status->joint_torque_external : status->joint_torque_measured);
  reading.halted = nullptr;
  return true;
}

void Iiwa::begin(const Joints& q) {
  target_ = q;
  speed_.setZero(q.size());
}

void Iiwa::advance(const Joints& dq, double dt) {
  target_ = (target_ + dt * dq).cwiseMax(lower_).cwiseMin(upper_);
  speed_ = (std::max(0.0, 1 - dt / kMemory) * speed_).cwiseMax(dq.cwiseAbs());
}

void Iiwa::send(const Joints& /*dq*/, std::int64_t utime) {
  const auto size = static_cast<std::size_t>(target_.size());
  std::copy(target_.data(), target_.data() + size, commands_.message().joint_position.begin());
  commands_.publish(utime);
}

bool Iiwa::follows(const Joints& q) const {
  return ((target_ - q).cwiseAbs().array() <= follow_ + kLag * speed_.array()).all();
}

}  // namespace palpate::drake_bridge
