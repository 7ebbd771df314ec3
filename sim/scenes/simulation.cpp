#include "sim/scenes/simulation.hpp"

#include <stdexcept>

namespace palpate::scenes {
namespace {

constexpr std::int64_t kTruthTicks = 10;   // 100 Hz
constexpr std::int64_t kMeshTicks = 1000;  // 1 Hz
constexpr double kSettlingTime = 60;       // s, simulated, at most
constexpr double kMotionGain = 10;         // 1/s, of the pose error onto the twist

std::unique_ptr<robot::Robot> make_robot(const config::Node& node, const Scene& scene) {
  try {
    auto robot = std::make_unique<robot::Robot>(robot::load_model(scene.urdf), scene.robot);
    robot->set_joints(scene.initial_joints);
    return robot;
  } catch (const std::invalid_argument& error) {
    node.child("robot").fail("", error.what());
  }
}

std::unique_ptr<object::HyperelasticPlant> make_plant(const config::Node& node, const Scene& scene,
                                                      const math::Pose& X_OG) {
  object::PlantOptions options = scene.plant;
  options.grasps.front().X_OG_rest = X_OG;
  if (scene.object_gravity)
    options.gravity_O = scene.X_WO.linear().transpose() * scene.robot.gravity_W;
  try {
    auto plant = std::make_unique<object::HyperelasticPlant>(options);
    if (!plant->settle(kSettlingTime).converged)
      throw std::invalid_argument("the object does not come to rest under its weight");
    return plant;
  } catch (const std::invalid_argument& error) {
    node.child("object").fail("", error.what());
  }
}

/// X_ET of each.
std::vector<math::Pose> fingertip_poses(const robot::Robot& robot) {
  std::vector<math::Pose> poses;
  for (const std::string& name : fingertips_of(robot))
    poses.push_back(robot.flange_pose().inverse() * robot.link_pose(name));
  return poses;
}

}  // namespace

Simulation::Simulation(const config::Node& node, bus::MessageBus& control,
                       bus::MessageBus& housekeeping, const Origin& origin)
    : scene_(read_scene(node)),
      origin_(origin),
      robot_(make_robot(node, scene_)),
      X_OG_first_(grasp_in_object()),
      plant_(make_plant(node, scene_, X_OG_first_)),
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
  const robot::ImuReading imu = robot_->imu();
  truth.imu.motion << imu.acceleration, imu.angular_velocity;
  truth.robot.q = robot_->joint_positions();
  truth.robot.dq = robot_->joint_velocities();
  truth.robot.tau = robot_->joint_torques();
  truth.robot.X_WE = robot_->flange_pose();
  truth.robot.V_W_E = robot_->flange_twist();
  truth.hand.holding = plant_->grasped();
  truth.hand.X_ET = fingertip_poses(*robot_);
  truth.hand.q = robot_->hand_positions();
  truth.jacobian = robot_->flange_jacobian();
  return truth;
}

void Simulation::step() {
  if (scene_.motion) {
    follow_motion();
  } else {
    commands_.apply(*robot_);
  }
  commands_.apply(hand_);
  hand_.step(tick_, *robot_);
  ++tick_;
  const math::Wrench on_object = plant_->hand_wrench();
  const Eigen::Matrix3d& R_WO = scene_.X_WO.linear();
  robot_->set_hand_load({-(R_WO * on_object.force), -(R_WO * on_object.torque)},
                        robot_->flange_pose() * scene_.X_EG.translation());
  robot_->step(kPeriod);
  pokes_.apply(time(), *plant_);
  plant_->step(kPeriod, grasp_in_object(), grasp_twist());

  const std::int64_t now_us = kPeriodUs * tick_;
  sensors_.sample(now_us, sense());
  sensor_publisher_.publish(sensors_, now_us);
  if (camera_) camera_->step(now_us, *robot_, *plant_);
  if (tick_ % kTruthTicks == 0) {
    truth_.publish_shape(*plant_, utime());
    truth_.publish_contact(*plant_, grasp_in_object(), utime());
  }
  if (tick_ % kMeshTicks == 1) truth_.publish_mesh(utime());
}

}  // namespace palpate::scenes
