#include "sim/scenes/command_receiver.hpp"

#include <palpate/channels.hpp>

#include <palpate/channels.hpp>

namespace palpate::scenes {
namespace {
constexpr int kDepth = 64;
}

CommandReceiver::CommandReceiver(bus::MessageBus& control, int arm,
                                 const std::optional<bus::Key>& key)
    : arm_(arm),
      twists_(control, channel::of_arm(channel::kTwistCommand, arm), kDepth),
      joints_(control, channel::of_arm(channel::kJointVelocityCommand, arm), kDepth),
      hands_(control, channel::of_arm(channel::kHandCommand, arm), kDepth),
      twist_admission_(channel::of_arm(channel::kTwistCommand, arm), {key, 0}),
      joint_admission_(channel::of_arm(channel::kJointVelocityCommand, arm), {key, 0}),
      hand_admission_(channel::of_arm(channel::kHandCommand, arm), {key, 0}) {}

void CommandReceiver::begin(std::int64_t start_us) {
  for (bus::ReplayGuard* admission : {&twist_admission_, &joint_admission_, &hand_admission_})
    admission->begin(start_us);
}

void CommandReceiver::apply(const twist_command_t& message, robot::Robot& robot) {
  const Eigen::Map<const math::Vector6d> twist(message.twist);
  if (twist_admission_.judge(message) != bus::Admitted::kFresh ||
      !twist_order_.accept(message.session, message.seq) || message.grasp != arm_ ||
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
  if (joint_admission_.judge(message) != bus::Admitted::kFresh ||
      !joint_order_.accept(message.session, message.seq) || message.grasp != arm_ ||
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

std::int64_t CommandReceiver::unauthorised() const {
  return twist_admission_.rejected() + joint_admission_.rejected() + hand_admission_.rejected();
}

std::int64_t CommandReceiver::lost() const {
  return twist_order_.lost() + joint_order_.lost() + hand_order_.lost() +
         twists_.counters().dropped + joints_.counters().dropped + hands_.counters().dropped;
}

void CommandReceiver::apply(HandControl& hand) {
  std::int64_t arrival_ns = 0;
  hand_command_t message;
  while (hands_.take(message, arrival_ns)) {
    const bool good = hand_admission_.judge(message) == bus::Admitted::kFresh &&
                      hand_order_.accept(message.session, message.seq) && hand.accept(message);
    ++(good ? accepted_ : rejected_);
  }
}

}  // namespace palpate::scenes
