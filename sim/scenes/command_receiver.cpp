#include "sim/scenes/command_receiver.hpp"

#include "sim/scenes/channels.hpp"

namespace palpate::scenes {
namespace {
constexpr int kDepth = 64;
}

CommandReceiver::CommandReceiver(bus::MessageBus& control, int arm)
    : arm_(arm),
      twists_(control, channel_of("TWIST_COMMAND", arm), kDepth),
      joints_(control, channel_of("JOINT_VELOCITY_COMMAND", arm), kDepth),
      hands_(control, channel_of("HAND_COMMAND", arm), kDepth) {}

void CommandReceiver::apply(const twist_command_t& message, robot::Robot& robot) {
  const Eigen::Map<const math::Vector6d> twist(message.twist);
  if (!twist_order_.accept(message.session, message.seq) || message.grasp != arm_ ||
      !twist.allFinite()) {
    ++rejected_;
    return;
  }
  ++accepted_;
  if (message.valid == 1) {
    robot.command_twist(math::Twist::from(twist));
  } else {
    robot.stop();
  }
}

void CommandReceiver::apply(const joint_velocity_command_t& message, robot::Robot& robot) {
  const int count = robot.joint_count();
  const Eigen::Map<const Eigen::VectorXd> velocity(message.dq, count);
  if (!joint_order_.accept(message.session, message.seq) || message.grasp != arm_ ||
      message.joint_count != count || !velocity.allFinite()) {
    ++rejected_;
    return;
  }
  ++accepted_;
  if (message.valid == 1) {
    robot.command_joints(velocity);
  } else {
    robot.stop();
  }
}

void CommandReceiver::apply(robot::Robot& robot) {
  std::int64_t arrival_ns = 0;
  twist_command_t twist;
  while (twists_.take(twist, arrival_ns)) apply(twist, robot);
  joint_velocity_command_t joints;
  while (joints_.take(joints, arrival_ns)) apply(joints, robot);
}

void CommandReceiver::apply(HandControl& hand) {
  std::int64_t arrival_ns = 0;
  hand_command_t message;
  while (hands_.take(message, arrival_ns)) {
    const bool good = hand_order_.accept(message.session, message.seq) && hand.accept(message);
    ++(good ? accepted_ : rejected_);
  }
}

}  // namespace palpate::scenes
