#include <palpate/channels.hpp>

#include "command_input.hpp"

namespace palpate::driver {

CommandInput::CommandInput(bus::MessageBus& control, int joint_count, const bus::Access& access)
    : joint_count_(joint_count),
      twists_(control, channel::kTwistCommand, access),
      joints_(control, channel::kJointVelocityCommand, access) {
  command_.dq.setZero(joint_count);
}

template <class Message, class Take>
void CommandInput::drain(Channel<Message>& channel, Take take) {
  Message message;
  std::int64_t arrival_ns = 0;
  while (channel.commands.take(message, arrival_ns)) {
    // The authentication code first: a forged message must not even affect the sequence.
    if (channel.admission.judge(message) != bus::Admitted::kFresh) continue;
    if (!channel.order.accept(message.session, message.seq) || message.grasp != 0 ||
        !take(message)) {
      ++counts_.rejected;
      continue;
    }
    ++counts_.obeyed;
    good_ns_ = arrival_ns;
    if (message.valid == 1) continue;
    command_.kind = Command::Kind::kStop;
    ++rest_commands_;
  }
}

bool CommandInput::take(const twist_command_t& message) {
  const Eigen::Map<const math::Vector6d> twist(message.twist);
  if (!twist.allFinite()) return false;
  command_.kind = Command::Kind::kTwist;
  command_.V_W_E = math::Twist::from(twist);
  return true;
}

bool CommandInput::take(const joint_velocity_command_t& message) {
  if (message.joint_count != joint_count_) return false;
  const Eigen::Map<const Eigen::VectorXd> dq(message.dq, joint_count_);
  if (!dq.allFinite()) return false;
  command_.kind = Command::Kind::kJoints;
  command_.dq = dq;
  return true;
}

const Command& CommandInput::read(std::int64_t now_ns) {
  drain(twists_, [this](const twist_command_t& message) { return take(message); });
  drain(joints_, [this](const joint_velocity_command_t& message) { return take(message); });
  if (command_.kind != Command::Kind::kStop && now_ns - good_ns_ > kSilence) {
    ++counts_.silences;
    command_.kind = Command::Kind::kStop;
  }
  return command_;
}

Counts CommandInput::counts() const {
  Counts counts = counts_;
  counts.unauthorised = twists_.admission.rejected() + joints_.admission.rejected();
  return counts;
}

}  // namespace palpate::driver
