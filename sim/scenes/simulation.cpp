#include "sim/scenes/simulation.hpp"

#include <algorithm>
#include <map>
#include <stdexcept>

namespace palpate::scenes {
namespace {

constexpr std::int64_t kTruthTicks = 10;   // 100 Hz
constexpr std::int64_t kMeshTicks = 1000;  // 1 Hz
constexpr double kSettlingTime = 60;       // s, simulated, at most
constexpr double kSlippingShare = 0.5;     // of the pads' area: not just its rim
constexpr double kMotionGain = 10;         // 1/s, of the pose error onto the twist

/// Of all the hand's joints, rad.
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

std::unique_ptr<robot::Robot> make_robot(const config::Node& node, const Scene& scene) {
  try {
    auto robot = std::make_unique<robot::Robot>(robot::load_model(scene.urdf), scene.robot);
    robot->set_joints(scene.initial_joints);
    if (!scene.initial_hand.empty()) robot->set_hand(initial_hand(*robot, scene.initial_hand));
    return robot;
  } catch (const std::invalid_argument& error) {
    node.child("robot").fail("", error.what());
  }
}

FingertipCoupling make_fingertips(const config::Node& node, const Scene& scene,
                                  const robot::Robot& robot) {
  try {
    return FingertipCoupling(scene.fingertips, robot, scene.X_WO);
  } catch (const std::invalid_argument& error) {
    node.fail("fingertips", error.what());
  }
}

std::unique_ptr<object::HyperelasticPlant> make_plant(const config::Node& node, const Scene& scene,
                                                      const math::Pose& X_OG,
                                                      const FingertipCoupling& fingertips,
                                                      const robot::Robot& robot) {
  object::PlantOptions options = scene.plant;
  if (!options.grasps.empty()) options.grasps.front().X_OG_rest = X_OG;
  if (scene.object_gravity)
    options.gravity_O = scene.X_WO.linear().transpose() * scene.robot.gravity_W;
  try {
    auto plant = std::make_unique<object::HyperelasticPlant>(options);
    fingertips.move(robot, *plant);
    if (!plant->settle(kSettlingTime).converged)
      throw std::invalid_argument("the object does not come to rest under its weight");
    return plant;
  } catch (const std::invalid_argument& error) {
    node.child("object").fail("", error.what());
  }
}

/// Whether the hand holds the object, and whether it slips: by its pads where it has some, by at
/// least two fingertips otherwise.
void judge_hold(const object::HyperelasticPlant& plant, sensors::HandReading& hand) {
  if (plant.grasped()) {
    hand.holding = true;
    hand.slipping = plant.grasp().slip().share > kSlippingShare;
    return;
  }
  int touching = 0, sticking = 0;
  for (int i = 0; i < plant.fingertip_count(); ++i) {
    touching += plant.fingertip(i).touch().touching;
    sticking += plant.fingertip(i).touch().sticking;
  }
  hand.holding = touching >= 2;
  hand.slipping = hand.holding && sticking < 2;
}

}  // namespace

Simulation::Simulation(const config::Node& node, bus::MessageBus& control,
                       bus::MessageBus& housekeeping, const Origin& origin)
    : scene_(read_scene(node)),
      origin_(origin),
      robot_(make_robot(node, scene_)),
      fingertips_(make_fingertips(node, scene_, *robot_)),
      X_OG_first_(grasp_in_object()),
      plant_(make_plant(node, scene_, X_OG_first_, fingertips_, *robot_)),
      pokes_(scene_.pokes, *plant_),
      hand_(*robot_),
      sensors_(scene_.sensors, scene_.seed, scene_.X_EG, robot_->joint_count()),
      commands_(control),
      sensor_publisher_(control, origin.session, origin.start_utime),
      camera_(scene_.camera ? std::make_unique<CameraPublisher>(control, scene_, *robot_,
                                                                origin.session, origin.start_utime)
                            : nullptr),
      truth_(housekeeping, *plant_, origin.session) {}

math::Pose Simulation::grasp_in_object() const {
  return scene_.X_WO.inverse() * robot_->flange_pose() * scene_.X_EG;
}

math::Twist Simulation::grasp_twist() const {
  const Eigen::Vector3d arm = robot_->flange_pose().linear() * scene_.X_EG.translation();
  const math::Twist V_W_G = math::move_reference(robot_->flange_twist(), arm);
  const Eigen::Matrix3d R_OW = scene_.X_WO.linear().transpose();
  return {R_OW * V_W_G.linear, R_OW * V_W_G.angular};
}

math::Pose Simulation::grasp_target() const {
  if (!scene_.motion) return X_OG_first_;
  const MotionPoint point = scene_.motion->at(time());
  return math::make_pose(point.rotation * X_OG_first_.linear(),
                         X_OG_first_.translation() + point.translation);
}

void Simulation::follow_motion() {
  const math::Pose target = grasp_target(), X_OG = grasp_in_object();
  math::Twist V = scene_.motion->at(time()).velocity;  // of G, in O
  V.linear += kMotionGain * (target.translation() - X_OG.translation());
  V.angular += kMotionGain * math::log_rotation(target.linear() * X_OG.linear().transpose());
  const Eigen::Matrix3d& R_WO = scene_.X_WO.linear();
  const Eigen::Vector3d arm = robot_->flange_pose().linear() * scene_.X_EG.translation();
  robot_->command_twist(math::move_reference(math::Twist{R_WO * V.linear, R_WO * V.angular}, -arm));
}

sensors::Truth Simulation::sense() const {
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
  judge_hold(*plant_, truth.hand);
  truth.hand.X_ET = fingertips_.poses_in_flange(*robot_);
  truth.hand.q = robot_->hand_positions();
  truth.touches = fingertips_.touches(*robot_, *plant_);
  truth.jacobian = robot_->flange_jacobian();
  return truth;
}

void Simulation::follow_hand_plan() {
  const std::vector<HandAction>& plan = scene_.hand;
  for (; next_action_ < plan.size() && plan[next_action_].at <= time(); ++next_action_)
    hand_.accept(plan[next_action_].command);
}

void Simulation::step() {
  obey();
  advance();
  publish();
  publish_truth();
}

void Simulation::obey() {
  if (!scene_.motion) commands_.apply(*robot_);
  commands_.apply(hand_);
}

void Simulation::advance() {
  if (scene_.motion) follow_motion();
  follow_hand_plan();
  hand_.step(tick_, *robot_);
  ++tick_;
  const math::Wrench on_object = plant_->hand_wrench();
  const Eigen::Matrix3d& R_WO = scene_.X_WO.linear();
  robot_->set_hand_load({-(R_WO * on_object.force), -(R_WO * on_object.torque)},
                        robot_->flange_pose() * scene_.X_EG.translation());
  fingertips_.load(*plant_, *robot_);
  robot_->step(kPeriod);
  pokes_.apply(time(), *plant_);
  fingertips_.move(*robot_, *plant_);
  plant_->step(kPeriod, grasp_in_object(), grasp_twist());

  sensors_.sample(kPeriodUs * tick_, sense());
}

void Simulation::publish() {
  const std::int64_t now_us = kPeriodUs * tick_;
  sensor_publisher_.publish(sensors_, now_us);
  if (camera_) camera_->step(now_us, *robot_, *plant_);
}

void Simulation::publish_truth() {
  if (tick_ % kTruthTicks == 0) {
    truth_.publish_shape(*plant_, utime());
    truth_.publish_contact(*plant_, grasp_in_object(), utime());
    if (fingertips_.tip_count() > 0) truth_.publish_touch(*plant_, fingertips_, utime());
  }
  if (tick_ % kMeshTicks == 1) truth_.publish_mesh(utime());
}

}  // namespace palpate::scenes
