#include "sim/scenes/command_receiver.hpp"

#include <palpate/channels.hpp>

namespace palpate::scenes {
namespace {
constexpr int kDepth = 64;
}

template <class Message>
CommandReceiver::Input<Message>::Input(bus::MessageBus& control, const std::string& channel,
                                       const std::optional<bus::Key>& key)
    : queue(control, channel, kDepth), admission(channel, {key, 0}) {}

CommandReceiver::CommandReceiver(bus::MessageBus& control, int arm,
                                 const std::optional<bus::Key>& key)
    : arm_(arm),
      twists_(control, channel::of_arm(channel::kTwistCommand, arm), key),
      joints_(control, channel::of_arm(channel::kJointVelocityCommand, arm), key),
      hands_(control, channel::of_arm(channel::kHandCommand, arm), key) {}

void CommandReceiver::begin(std::int64_t start_us) {
  for (bus::ReplayGuard* admission : {&twists_.admission, &joints_.admission, &hands_.admission})
    admission->begin(start_us);
}

template <class Message, class Take>
void CommandReceiver::drain(Input<Message>& input, Take take) {
  std::int64_t arrival_ns = 0;
  Message message;
  while (input.queue.take(message, arrival_ns)) {
    const bool good = input.admission.judge(message) == bus::Admitted::kFresh &&
                      input.order.accept(message.session, message.seq) && take(message);
    ++(good ? accepted_ : rejected_);
  }
}

void CommandReceiver::apply(robot::Robot& robot) {
  drain(twists_, [&](const twist_command_t& message) {
    const Eigen::Map<const math::Vector6d> twist(message.twist);
    if (message.grasp != arm_ || !twist.allFinite()) return false;
    message.valid == 1 ? robot.command_twist(math::Twist::from(twist)) : robot.stop();
    return true;
  });
  drain(joints_, [&](const joint_velocity_command_t& message) {
    const int count = robot.joint_count();
    const Eigen::Map<const Eigen::VectorXd> velocity(message.dq, count);
    if (message.grasp != arm_ || message.joint_count != count || !velocity.allFinite())
      return false;
    message.valid == 1 ? robot.command_joints(velocity) : robot.stop();
    return true;
  });
}

void CommandReceiver::apply(HandControl& hand) {
  drain(hands_, [&hand](const hand_command_t& message) { return hand.accept(message); });
}

std::int64_t CommandReceiver::unauthorised() const {
  return twists_.admission.rejected() + joints_.admission.rejected() + hands_.admission.rejected();
}

std::int64_t CommandReceiver::lost() const {
  return twists_.lost() + joints_.lost() + hands_.lost();
}

}  // namespace palpate::scenes
