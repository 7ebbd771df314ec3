#include "sim/scenes/hand_control.hpp"

#include "sim/scenes/fingertips.hpp"

namespace palpate::scenes {
namespace {

constexpr const char* kThumb = "th_tip";
constexpr std::int64_t kTicks = 10;  // 100 Hz
constexpr double kThumbStep = 0.03;  // rad
constexpr double kBandRatio =
    0.1;  // lower relative to upper end of the band, as the thesis' 0.1 N to 1 N

/// The first joint of a finger abducts it, or rotates the thumb; the others close it.
std::vector<robot::Finger> fingers_of(const robot::Robot& robot) {
  std::vector<robot::Finger> fingers;
  for (const std::string& tip : fingertips_of(robot)) {
    robot::Finger finger;
    finger.joints = robot.hand_joints_to(tip);
    if (finger.joints.size() > 1) finger.joints.erase(finger.joints.begin());
    if (tip == kThumb) finger.step = kThumbStep;
    fingers.push_back(finger);
  }
  return fingers;
}

}  // namespace

HandControl::HandControl(const robot::Robot& robot)
    : tips_(fingertips_of(robot)), grasp_(fingers_of(robot), robot.hand_limits()) {
  grasp_.reset(robot.hand_positions());
}

bool HandControl::accept(const hand_command_t& command) {
  if (command.action == hand_command_t::OPEN) {
    grasp_.open();
  } else if (command.action == hand_command_t::CLOSE) {
    grasp_.close();
  } else if (command.action == hand_command_t::HOLD && command.force > 0 &&
             command.force <= kMostForce) {
    grasp_.close({kBandRatio * command.force, command.force});
  } else {
    return false;
  }
  commanded_ = true;
  jaws_ = command.action == hand_command_t::OPEN ? Jaws::kOpen : Jaws::kClose;
  return true;
}

void HandControl::step(std::int64_t tick, robot::Robot& robot) {
  if (!commanded_ || tick % kTicks != 0) return;
  Eigen::VectorXd force(tips_.size());
  for (std::size_t i = 0; i < tips_.size(); ++i) force(i) = robot.link_load(tips_[i]).force.norm();
  robot.command_hand(grasp_.step(robot.hand_positions(), force));
}

}  // namespace palpate::scenes
