#include "sim/scenes/arm.hpp"

#include <algorithm>
#include <stdexcept>

namespace palpate::scenes {
namespace {

constexpr const char* kKeys[] = {"robot", "second_arm"};
constexpr double kSlippingShare = 0.5;  // fraction of the pads' area: more than their rim
constexpr double kMotionGain = 10;      // 1/s, gain from the pose error to the twist

/// Of all joints of the hand, rad.
Eigen::VectorXd initial_hand(const robot::Robot& robot,
                             const std::map<std::string, double>& joints) {
  const std::vector<std::string>& names = robot.hand_joint_names();
  Eigen::VectorXd q = Eigen::VectorXd::Zero(names.size());
  for (const auto& [name, angle] : joints) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) throw std::invalid_argument("the hand has no joint named " + name);
    q(found - names.begin()) = angle;
  }
  return q;
}

std::unique_ptr<robot::Robot> make_robot(const config::Node& node, const ArmScene& scene) {
  try {
    auto robot = std::make_unique<robot::Robot>(robot::load_model(scene.urdf), scene.robot);
    robot->set_joints(scene.initial_joints);
    if (!scene.initial_hand.empty()) robot->set_hand(initial_hand(*robot, scene.initial_hand));
    return robot;
  } catch (const std::invalid_argument& error) {
    node.fail("", error.what());
  }
}

FingertipCoupling make_fingertips(const config::Node& root, const ArmScene& scene,
                                  const robot::Robot& robot) {
  try {
    return FingertipCoupling(scene.fingertips, robot, scene.X_WO);
  } catch (const std::invalid_argument& error) {
    root.fail("fingertips", error.what());
  }
}

/// Whether the hand holds the object, and whether it slips: judged by its pads if it has any,
/// otherwise by at least two fingertips.
void judge_hold(const object::Plant& plant, int hand, int tips, sensors::HandReading& reading) {
  if (plant.grasped(hand)) {
    reading.holding = true;
    reading.slipping = plant.slipping_share(hand) > kSlippingShare;
    return;
  }
  int touching = 0, sticking = 0;
  for (int i = 0; i < tips; ++i) {
    touching += plant.touch(i).touching;
    sticking += plant.touch(i).sticking;
  }
  reading.holding = touching >= 2;
  reading.slipping = reading.holding && sticking < 2;
}

}  // namespace

Arm::Arm(const config::Node& root, const ArmScene& scene, int index, std::uint64_t seed,
         bus::MessageBus& control, std::int64_t session, std::int64_t start_utime)
    : scene_(scene),
      index_(index),
      robot_(make_robot(root.child(kKeys[index]), scene_)),
      fingertips_(make_fingertips(root, scene_, *robot_)),
      X_OG_first_(grasp_in_object()),
      hand_(*robot_),
      sensors_(scene_.sensors, seed, scene_.X_EG, robot_->joint_count()),
      commands_(control, index, scene_.key),
      publisher_(control, session, start_utime, index) {}

math::Pose Arm::grasp_in_object() const {
  return scene_.X_WO.inverse() * robot_->flange_pose() * scene_.X_EG;
}

math::Twist Arm::grasp_twist() const {
  const Eigen::Vector3d arm = robot_->flange_pose().linear() * scene_.X_EG.translation();
  const math::Twist V_W_G = math::move_reference(robot_->flange_twist(), arm);
  const Eigen::Matrix3d R_OW = scene_.X_WO.linear().transpose();
  return {R_OW * V_W_G.linear, R_OW * V_W_G.angular};
}

math::Pose Arm::grasp_target(double time) const {
  if (!scene_.motion) return X_OG_first_;
  const MotionPoint point = scene_.motion->at(time);
  return math::make_pose(point.rotation * X_OG_first_.linear(),
                         X_OG_first_.translation() + point.translation);
}

void Arm::follow_motion(double time) {
  const math::Pose target = grasp_target(time), X_OG = grasp_in_object();
  math::Twist V = scene_.motion->at(time).velocity;  // of G, in O
  V.linear += kMotionGain * (target.translation() - X_OG.translation());
  V.angular += kMotionGain * math::log_rotation(target.linear() * X_OG.linear().transpose());
  const Eigen::Matrix3d& R_WO = scene_.X_WO.linear();
  const Eigen::Vector3d arm = robot_->flange_pose().linear() * scene_.X_EG.translation();
  robot_->command_twist(math::move_reference(math::Twist{R_WO * V.linear, R_WO * V.angular}, -arm));
}

void Arm::follow_hand_plan(double time) {
  const std::vector<HandAction>& plan = scene_.hand;
  for (; next_action_ < plan.size() && plan[next_action_].at <= time; ++next_action_)
    hand_.accept(plan[next_action_].command);
}

void Arm::obey() {
  if (!scene_.motion) commands_.apply(*robot_);
  commands_.apply(hand_);
}

void Arm::step(std::int64_t tick, double time, double dt, const object::Plant& plant) {
  if (scene_.motion) follow_motion(time);
  follow_hand_plan(time);
  hand_.step(tick, *robot_);
  const math::Wrench on_object = plant.hand_wrench(index_);
  const Eigen::Matrix3d& R_WO = scene_.X_WO.linear();
  robot_->set_hand_load({-(R_WO * on_object.force), -(R_WO * on_object.torque)},
                        robot_->flange_pose() * scene_.X_EG.translation());
  fingertips_.load(plant, *robot_);
  robot_->step(dt);
}

void Arm::lead(object::Plant& plant) const {
  fingertips_.move(*robot_, plant);
  if (index_ >= plant.grasp_count()) return;
  if (hand_.jaws() == HandControl::Jaws::kOpen) plant.open_hand(index_);
  if (hand_.jaws() == HandControl::Jaws::kClose) plant.close_hand(index_);
  plant.move_hand(index_, grasp_in_object(), grasp_twist());
}

sensors::Truth Arm::truth(const object::Plant& plant) const {
  sensors::Truth truth;
  truth.force_torque.wrench = robot_->sensor_wrench().vector();
  truth.X_WS = robot_->link_pose(scene_.robot.frames.sensor);
  const robot::ImuReading imu = robot_->imu();
  truth.imu.motion << imu.acceleration, imu.angular_velocity;
  truth.robot.q = robot_->joint_positions();
  truth.robot.dq = robot_->joint_velocities();
  truth.robot.tau = robot_->joint_torques();
  truth.robot.X_WE = robot_->flange_pose();
  truth.robot.V_W_E = robot_->flange_twist();
  judge_hold(plant, index_, fingertips_.tip_count(), truth.hand);
  truth.hand.X_ET = fingertips_.poses_in_flange(*robot_);
  truth.hand.q = robot_->hand_positions();
  truth.touches = fingertips_.touches(*robot_, plant);
  truth.jacobian = robot_->flange_jacobian();
  return truth;
}

void Arm::sample(std::int64_t now_us, const object::Plant& plant) {
  sensors_.sample(now_us, truth(plant));
}

void Arm::publish(std::int64_t now_us) { publisher_.publish(sensors_, now_us); }

}  // namespace palpate::scenes
