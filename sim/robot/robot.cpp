#include "sim/robot/robot.hpp"

#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/DegreeOfFreedom.hpp>
#include <dart/dynamics/Joint.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dart/simulation/World.hpp>
#include <dart/utils/urdf/DartLoader.hpp>

#include <cmath>
#include <stdexcept>

// Never take a dynamic Eigen object from DART by value, nor give it one: the two sides allocate
// differently (see CMakeLists.txt).
namespace palpate::robot {
namespace dd = dart::dynamics;
namespace {

/// DART gives a link without inertia one kilogram; frames shall weigh nothing that could be felt.
dd::Inertia weightless() {
  dd::Inertia inertia;
  inertia.setMass(1e-9);
  inertia.setMoment(1e-12 * Eigen::Matrix3d::Identity());
  return inertia;
}

dd::SkeletonPtr load_skeleton(const RobotModel& model) {
  using Loader = dart::utils::DartLoader;
  Loader loader(Loader::Options(nullptr, Loader::RootJointType::FIXED, weightless()));
  dd::SkeletonPtr skeleton = loader.parseSkeletonString(model.text, dart::common::Uri("file:///"));
  if (!skeleton) throw std::invalid_argument("DART cannot build the robot of this URDF file");
  // A root link named world stands for DART's own frame and becomes no body.
  const int bodies = static_cast<int>(skeleton->getNumBodyNodes());
  if (bodies != model.link_count && bodies != model.link_count - 1)
    throw std::invalid_argument("DART built " + std::to_string(bodies) + " bodies from " +
                                std::to_string(model.link_count) + " links");
  return skeleton;
}

}  // namespace

struct Robot::Dynamics {
  dart::simulation::WorldPtr world = dart::simulation::World::create();
  dd::SkeletonPtr skeleton;
  dd::BodyNode* flange = nullptr;
  dd::BodyNode* sensor = nullptr;
  dd::BodyNode* imu = nullptr;
  std::vector<dd::BodyNode*> load;        // bodies beyond S
  std::vector<dd::DegreeOfFreedom*> arm;  // driven joints, from the base on
  std::unique_ptr<VelocityFollower> follower;
  Eigen::Vector3d gravity;
  double proportional = 0, derivative = 0;
  math::Wrench hand_load;  // about hand_point, in W
  Eigen::Vector3d hand_point = Eigen::Vector3d::Zero();
  Eigen::VectorXd torque;

  dd::BodyNode* body(const std::string& name) const {
    dd::BodyNode* found = skeleton->getBodyNode(name);
    if (!found) throw std::invalid_argument("the robot has no link named " + name);
    return found;
  }

  template <class Get>
  Eigen::VectorXd each(Get get) const {
    Eigen::VectorXd values(arm.size());
    for (std::size_t i = 0; i < arm.size(); ++i) values(i) = get(*arm[i]);
    return values;
  }

  void find_frames(const FrameNames& names) {
    flange = body(names.flange);
    sensor = body(names.sensor);
    imu = body(names.imu);
    for (dd::BodyNode* b = flange; b; b = b->getParentBodyNode())
      for (std::size_t i = b->getParentJoint()->getNumDofs(); i-- > 0;)
        arm.insert(arm.begin(), b->getParentJoint()->getDof(i));
    if (arm.empty()) throw std::invalid_argument("no moving joint leads to " + names.flange);
    if (arm.size() > 16) throw std::invalid_argument("the arm has more than 16 joints");
    for (dd::BodyNode* b : skeleton->getBodyNodes())
      for (dd::BodyNode* up = b; up; up = up->getParentBodyNode())
        if (up == sensor) load.push_back(b);
  }

  JointLimits prepare_joints() {
    for (std::size_t j = 0; j < skeleton->getNumJoints(); ++j) {
      dd::Joint* joint = skeleton->getJoint(j);
      joint->setLimitEnforcement(true);
      joint->setActuatorType(dd::Joint::LOCKED);
    }
    JointLimits limits;
    for (dd::DegreeOfFreedom* dof : arm) {
      dof->getJoint()->setActuatorType(dd::Joint::FORCE);
      if (!(dof->getVelocityUpperLimit() > 0) || !std::isfinite(dof->getVelocityUpperLimit()) ||
          !(dof->getForceUpperLimit() > 0) || !std::isfinite(dof->getForceUpperLimit()))
        throw std::invalid_argument(dof->getName() + ": a driven joint needs finite limits of " +
                                    "velocity and effort above zero");
    }
    limits.lower = each([](const auto& dof) { return dof.getPositionLowerLimit(); });
    limits.upper = each([](const auto& dof) { return dof.getPositionUpperLimit(); });
    limits.velocity = each([](const auto& dof) { return dof.getVelocityUpperLimit(); });
    limits.torque = each([](const auto& dof) { return dof.getForceUpperLimit(); });
    return limits;
  }

  /// Computed torque: M (ddq_d + K_d (dq_d - dq) + K_p (q_d - q)) + c + g - J^T F. The object's
  /// load is taken into account as an arm with joint torque sensors does.
  void apply_torque() {
    const Eigen::VectorXd q = each([](const auto& dof) { return dof.getPosition(); });
    const Eigen::VectorXd dq = each([](const auto& dof) { return dof.getVelocity(); });
    const Eigen::VectorXd ddq = follower->acceleration() +
                                derivative * (follower->velocity() - dq) +
                                proportional * (follower->position() - q);
    const Eigen::MatrixXd& mass = skeleton->getMassMatrix();
    const Eigen::VectorXd& bias = skeleton->getCoriolisAndGravityForces();
    const Eigen::VectorXd& external = skeleton->getExternalForces();
    for (std::size_t i = 0; i < arm.size(); ++i) {
      const std::size_t row = arm[i]->getIndexInSkeleton();
      double tau = bias(row) - external(row);
      for (std::size_t j = 0; j < arm.size(); ++j)
        tau += mass(row, arm[j]->getIndexInSkeleton()) * ddq(j);
      const double most = follower->limits().torque(i);
      torque(i) = std::max(-most, std::min(most, tau));
      arm[i]->setForce(torque(i));
    }
  }
};

Robot::Robot(const RobotModel& model, const RobotOptions& options)
    : dynamics_(std::make_unique<Dynamics>()), visuals_(model.visuals) {
  Dynamics& d = *dynamics_;
  d.skeleton = load_skeleton(model);
  d.gravity = options.gravity_W;
  d.world->setGravity(d.gravity);
  d.world->addSkeleton(d.skeleton);
  d.find_frames(options.frames);
  d.follower = std::make_unique<VelocityFollower>(d.prepare_joints(), options.follower);
  const double omega = 2 * M_PI * options.bandwidth;
  d.proportional = omega * omega;
  d.derivative = 2 * omega;
  d.torque = Eigen::VectorXd::Zero(joint_count());
}

Robot::~Robot() = default;

int Robot::joint_count() const { return static_cast<int>(dynamics_->arm.size()); }
const JointLimits& Robot::limits() const { return dynamics_->follower->limits(); }

void Robot::set_joints(const Eigen::VectorXd& q) {
  Dynamics& d = *dynamics_;
  d.follower->reset(q);
  for (int i = 0; i < joint_count(); ++i)
    if (!(q(i) >= limits().lower(i) && q(i) <= limits().upper(i)))
      throw std::invalid_argument("joint " + std::to_string(i) + " (" + d.arm[i]->getName() +
                                  ") is beyond its limits");
  for (int i = 0; i < joint_count(); ++i) {
    d.arm[i]->setPosition(q(i));
    d.arm[i]->setVelocity(0);
    d.arm[i]->setAcceleration(0);
  }
}

void Robot::command_twist(const math::Twist& V_WE) { dynamics_->follower->command_twist(V_WE); }
void Robot::command_joints(const Eigen::VectorXd& joint_velocity) {
  dynamics_->follower->command_joints(joint_velocity);
}
void Robot::stop() { dynamics_->follower->stop(); }

void Robot::set_hand_load(const math::Wrench& F_W, const Eigen::Vector3d& p_W) {
  dynamics_->hand_load = F_W;
  dynamics_->hand_point = p_W;
}

void Robot::step(double dt) {
  Dynamics& d = *dynamics_;
  d.follower->step(dt, flange_jacobian(), joint_positions());
  const math::Wrench at_sensor =
      math::move_reference(d.hand_load, d.sensor->getWorldTransform().translation() - d.hand_point);
  d.sensor->addExtForce(at_sensor.force);
  d.sensor->addExtTorque(at_sensor.torque);
  d.apply_torque();
  d.world->setTimeStep(dt);
  d.world->step(true);  // clears forces
}

Eigen::VectorXd Robot::joint_positions() const {
  return dynamics_->each([](const auto& dof) { return dof.getPosition(); });
}
Eigen::VectorXd Robot::joint_velocities() const {
  return dynamics_->each([](const auto& dof) { return dof.getVelocity(); });
}
Eigen::VectorXd Robot::joint_torques() const { return dynamics_->torque; }

math::Pose Robot::flange_pose() const { return dynamics_->flange->getWorldTransform(); }

math::Twist Robot::flange_twist() const {
  return {dynamics_->flange->getLinearVelocity(), dynamics_->flange->getAngularVelocity()};
}

Eigen::Matrix<double, 6, Eigen::Dynamic> Robot::flange_jacobian() const {
  const Dynamics& d = *dynamics_;
  // By reference. Its columns are the joints between the root and the
  // flange, angular rows first.
  const dart::math::Jacobian& all = d.flange->getWorldJacobian();
  Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(6, joint_count());
  jacobian << all.bottomRows<3>(), all.topRows<3>();
  return jacobian;
}

math::Wrench Robot::sensor_wrench() const {
  const Dynamics& d = *dynamics_;
  const math::Pose X_WS = d.sensor->getWorldTransform();
  math::Wrench sum;  // about the origin of S, in W
  for (const dd::BodyNode* body : d.load) {
    const Eigen::Matrix3d R = body->getWorldTransform().linear();
    const dd::Inertia& inertia = body->getInertia();
    const Eigen::Matrix3d moment = R * inertia.getMoment() * R.transpose();
    const Eigen::Vector3d omega = body->getAngularVelocity();
    const Eigen::Vector3d force =
        inertia.getMass() * (body->getLinearAcceleration(inertia.getLocalCOM(), dd::Frame::World(),
                                                         dd::Frame::World()) -
                             d.gravity);
    sum.force += force;
    sum.torque +=
        (body->getWorldTransform() * inertia.getLocalCOM() - X_WS.translation()).cross(force) +
        moment * body->getAngularAcceleration() + omega.cross(moment * omega);
  }
  const math::Wrench load = math::move_reference(d.hand_load, X_WS.translation() - d.hand_point);
  const Eigen::Matrix3d R_SW = X_WS.linear().transpose();
  return {R_SW * (sum.force - load.force), R_SW * (sum.torque - load.torque)};
}

ImuReading Robot::imu() const {
  const dd::BodyNode& body = *dynamics_->imu;
  const Eigen::Matrix3d R_IW = body.getWorldTransform().linear().transpose();
  return {R_IW * (body.getLinearAcceleration() - dynamics_->gravity),
          R_IW * body.getAngularVelocity()};
}

bool Robot::has_link(const std::string& name) const {
  return dynamics_->skeleton->getBodyNode(name) != nullptr;
}

math::Pose Robot::link_pose(const std::string& name) const {
  return dynamics_->body(name)->getWorldTransform();
}

}  // namespace palpate::robot
