#include "sim/robot/robot.hpp"

#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dart/simulation/World.hpp>
#include <dart/utils/urdf/DartLoader.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "sim/robot/dart_options.hpp"
#include "sim/robot/joint_access.hpp"

// Never take a dynamic Eigen object from DART by value or pass one to it: the two sides allocate
// differently (see CMakeLists.txt).
namespace palpate::robot {
namespace dd = dart::dynamics;
namespace {

/// DART gives a link without inertia a mass of one kilogram; frame links get a negligible one.
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
  // A root link named world is DART's own frame and does not become a body.
  const int bodies = static_cast<int>(skeleton->getNumBodyNodes());
  if (bodies != model.link_count && bodies != model.link_count - 1)
    throw std::invalid_argument("DART built " + std::to_string(bodies) + " bodies from " +
                                std::to_string(model.link_count) + " links");
  return skeleton;
}

/// External wrench on a body, in W.
struct ExternalLoad {
  dd::BodyNode* body;
  math::Wrench wrench;
  Eigen::Vector3d point;  // reference point of the wrench

  math::Wrench about(const Eigen::Vector3d& p_W) const {
    return math::move_reference(wrench, p_W - point);
  }
};

}  // namespace

struct Robot::Dynamics {
  dart::simulation::WorldPtr world = dart::simulation::World::create();
  dd::SkeletonPtr skeleton;
  std::vector<std::string> remarks;
  dd::BodyNode* flange = nullptr;
  dd::BodyNode* sensor = nullptr;
  dd::BodyNode* imu = nullptr;
  std::vector<dd::BodyNode*> load;  // bodies beyond S
  Joints arm;                       // from the base on
  std::unique_ptr<VelocityFollower> follower;
  std::unique_ptr<HandDrive> hand;
  Eigen::Vector3d gravity;
  double proportional = 0, derivative = 0;
  std::vector<ExternalLoad> external;  // the first one belongs to the hand
  Eigen::VectorXd torque, inverse;
  bool torque_limited = false;
  std::int64_t torque_limited_steps = 0;

  dd::BodyNode* body(const std::string& name) const {
    dd::BodyNode* found = skeleton->getBodyNode(name);
    if (!found) throw std::invalid_argument("the robot has no link named " + name);
    return found;
  }

  /// The load set by set_link_load, or none.
  ExternalLoad* load_on(const dd::BodyNode* link) {
    const auto known =
        std::find_if(external.begin() + 1, external.end(),
                     [link](const ExternalLoad& on_body) { return on_body.body == link; });
    return known == external.end() ? nullptr : &*known;
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
      if (is_beyond(b, sensor)) load.push_back(b);
  }

  /// Changes what the sensor carries: scales the links beyond S and fixes `load` to the first.
  void add_load(double hand_mass_factor, const Load& added) {
    for (dd::BodyNode* b : load) {
      dd::Inertia inertia = b->getInertia();
      inertia.setMass(hand_mass_factor * inertia.getMass());
      inertia.setMoment(hand_mass_factor * inertia.getMoment());
      b->setInertia(inertia);
    }
    if (added.mass == 0) return;
    const dd::Inertia& own = sensor->getInertia();
    const double mass = own.getMass() + added.mass;
    const Eigen::Vector3d center =
        (own.getMass() * own.getLocalCOM() + added.mass * added.center_of_mass) / mass;
    const math::Vector6d& i = added.inertia;
    Eigen::Matrix3d about_center;
    about_center << i[0], i[1], i[2], i[1], i[3], i[4], i[2], i[4], i[5];
    const auto moved = [&center](double of_mass, const Eigen::Vector3d& from) {
      const Eigen::Vector3d d = from - center;
      return Eigen::Matrix3d(of_mass *
                             (d.squaredNorm() * Eigen::Matrix3d::Identity() - d * d.transpose()));
    };
    sensor->setInertia(dd::Inertia(mass, center,
                                   own.getMoment() + moved(own.getMass(), own.getLocalCOM()) +
                                       about_center + moved(added.mass, added.center_of_mass)));
  }

  /// Whether `ancestor` is `body` itself or lies between it and the root.
  static bool is_beyond(const dd::BodyNode* body, const dd::BodyNode* ancestor) {
    while (body && body != ancestor) body = body->getParentBodyNode();
    return body;
  }

  static bool is_limited(const dd::DegreeOfFreedom& dof) {
    return dof.getVelocityUpperLimit() > 0 && std::isfinite(dof.getVelocityUpperLimit()) &&
           dof.getForceUpperLimit() > 0 && std::isfinite(dof.getForceUpperLimit());
  }

  Joints find_hand() const {
    Joints joints;
    for (dd::DegreeOfFreedom* dof : skeleton->getDofs())
      if (is_beyond(dof->getJoint()->getParentBodyNode(), flange) && is_limited(*dof))
        joints.push_back(dof);
    return joints;
  }

  void prepare_joints() {
    for (std::size_t j = 0; j < skeleton->getNumJoints(); ++j) {
      dd::Joint* joint = skeleton->getJoint(j);
      joint->setLimitEnforcement(true);
      joint->setActuatorType(dd::Joint::LOCKED);
    }
    for (dd::DegreeOfFreedom* dof : arm) {
      dof->getJoint()->setActuatorType(dd::Joint::FORCE);
      if (!is_limited(*dof))
        throw std::invalid_argument(dof->getName() + ": a driven joint needs finite limits of " +
                                    "velocity and effort above zero");
    }
  }

  void apply_loads() {
    for (const ExternalLoad& on_body : external) {
      const math::Wrench F = on_body.about(on_body.body->getWorldTransform().translation());
      on_body.body->addExtForce(F.force);
      on_body.body->addExtTorque(F.torque);
    }
  }

  /// Torques (N m, of the whole skeleton) of the motion in which the arm's joints accelerate as
  /// given and all others keep their velocity: M ddq + c + g, in O(n) by the recursive Newton-Euler
  /// algorithm.
  const Eigen::VectorXd& inverse_dynamics(const Eigen::VectorXd& ddq) {
    for (std::size_t i = 0; i < skeleton->getNumDofs(); ++i)
      skeleton->getDof(i)->setAcceleration(0);
    for (std::size_t i = 0; i < arm.size(); ++i) arm[i]->setAcceleration(ddq(i));
    skeleton->computeInverseDynamics(false, false, false);
    for (std::size_t i = 0; i < skeleton->getNumDofs(); ++i)
      inverse(i) = skeleton->getDof(i)->getForce();
    return inverse;
  }

  /// Computed torque: M (ddq_d + K_d (dq_d - dq) + K_p (q_d - q)) + c + g - J^T F. The object's
  /// load is compensated, as an arm with joint torque sensors does.
  void apply_torque(double dt, const Eigen::Matrix<double, 6, Eigen::Dynamic>& jacobian) {
    // Errors at the current instant: the follower's step leads to the end of the tick.
    const Eigen::VectorXd feedback = derivative * (follower->velocity() - velocities(arm)) +
                                     proportional * (follower->position() - positions(arm));
    follower->step(dt, jacobian, positions(arm));
    const Eigen::VectorXd& tau = inverse_dynamics(follower->acceleration() + feedback);
    hand->step(dt, tau);
    const Eigen::VectorXd& outside = skeleton->getExternalForces();
    torque_limited = false;
    for (std::size_t i = 0; i < arm.size(); ++i) {
      const std::size_t row = arm[i]->getIndexInSkeleton();
      const double wanted = tau(row) - outside(row), most = follower->limits().torque(i);
      torque_limited = torque_limited || std::abs(wanted) > most;
      torque(i) = std::clamp(wanted, -most, most);
      arm[i]->setForce(torque(i));
    }
    if (torque_limited) ++torque_limited_steps;
  }
};

Robot::Robot(const RobotModel& model, const RobotOptions& options)
    : dynamics_(std::make_unique<Dynamics>()), visuals_(model.visuals) {
  Dynamics& d = *dynamics_;
  d.skeleton = load_skeleton(model);
  d.remarks = model.remarks;
  d.gravity = options.gravity_W;
  d.world->setGravity(d.gravity);
  d.world->addSkeleton(d.skeleton);
  d.find_frames(options.frames);
  d.add_load(options.hand_mass_factor, options.load);
  d.prepare_joints();
  d.follower = std::make_unique<VelocityFollower>(limits_of(d.arm), options.follower);
  d.hand = std::make_unique<HandDrive>(d.find_hand(), options.hand);
  for (const dd::DegreeOfFreedom* dof : d.hand->joints())
    hand_joint_names_.push_back(dof->getName());
  d.external.push_back({d.sensor, math::Wrench(), Eigen::Vector3d::Zero()});
  const double omega = 2 * M_PI * options.bandwidth;
  d.proportional = omega * omega;
  d.derivative = 2 * omega;
  d.torque = Eigen::VectorXd::Zero(joint_count());
  d.inverse = Eigen::VectorXd::Zero(d.skeleton->getNumDofs());
}

Robot::Robot(Robot&& other) noexcept = default;
Robot::~Robot() = default;

int Robot::joint_count() const { return static_cast<int>(dynamics_->arm.size()); }
const JointLimits& Robot::limits() const { return dynamics_->follower->limits(); }

void Robot::set_joints(const Eigen::VectorXd& q) {
  Dynamics& d = *dynamics_;
  set_at_rest(d.arm, limits(), q);
  d.follower->reset(q);
}

void Robot::command_twist(const math::Twist& V_WE) { dynamics_->follower->command_twist(V_WE); }
void Robot::command_joints(const Eigen::VectorXd& joint_velocity) {
  dynamics_->follower->command_joints(joint_velocity);
}
void Robot::stop() { dynamics_->follower->stop(); }

void Robot::set_hand_load(const math::Wrench& F_W, const Eigen::Vector3d& p_W) {
  dynamics_->external.front().wrench = F_W;
  dynamics_->external.front().point = p_W;
}

void Robot::set_link_load(const std::string& link, const math::Wrench& F_W,
                          const Eigen::Vector3d& p_W) {
  dd::BodyNode* body = dynamics_->body(link);
  if (ExternalLoad* known = dynamics_->load_on(body)) {
    *known = {body, F_W, p_W};
  } else {
    dynamics_->external.push_back({body, F_W, p_W});
  }
}

math::Wrench Robot::link_load(const std::string& link) const {
  const ExternalLoad* known = dynamics_->load_on(dynamics_->body(link));
  return known ? known->wrench : math::Wrench();
}

const std::vector<std::string>& Robot::remarks() const { return dynamics_->remarks; }
std::string Robot::effective_options() const { return robot::effective_options(*dynamics_->world); }

void Robot::step(double dt) {
  Dynamics& d = *dynamics_;
  d.apply_loads();
  d.apply_torque(dt, flange_jacobian());
  d.world->setTimeStep(dt);
  d.world->step(true);  // clears forces
}

Eigen::VectorXd Robot::joint_positions() const { return positions(dynamics_->arm); }
Eigen::VectorXd Robot::joint_velocities() const { return velocities(dynamics_->arm); }
Eigen::VectorXd Robot::joint_torques() const { return dynamics_->torque; }
bool Robot::torque_limited() const { return dynamics_->torque_limited; }
std::int64_t Robot::torque_limited_steps() const { return dynamics_->torque_limited_steps; }

math::Pose Robot::flange_pose() const { return dynamics_->flange->getWorldTransform(); }

math::Twist Robot::flange_twist() const {
  return {dynamics_->flange->getLinearVelocity(), dynamics_->flange->getAngularVelocity()};
}

Eigen::Matrix<double, 6, Eigen::Dynamic> Robot::flange_jacobian() const {
  const Dynamics& d = *dynamics_;
  // Returned by reference. The columns are the joints between the root and the flange, angular rows
  // first.
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
  for (const ExternalLoad& on_body : d.external) {
    if (!Dynamics::is_beyond(on_body.body, d.sensor)) continue;
    const math::Wrench F = on_body.about(X_WS.translation());
    sum.force -= F.force;
    sum.torque -= F.torque;
  }
  const Eigen::Matrix3d R_SW = X_WS.linear().transpose();
  return {R_SW * sum.force, R_SW * sum.torque};
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

math::Twist Robot::link_twist(const std::string& name) const {
  const dd::BodyNode* body = dynamics_->body(name);
  return {body->getLinearVelocity(), body->getAngularVelocity()};
}

std::vector<int> Robot::hand_joints_to(const std::string& link) const {
  const dd::BodyNode* tip = dynamics_->body(link);
  const Joints& joints = dynamics_->hand->joints();
  std::vector<int> found;
  for (std::size_t i = 0; i < joints.size(); ++i)
    if (Dynamics::is_beyond(tip, joints[i]->getChildBodyNode())) found.push_back(i);
  return found;
}

const JointLimits& Robot::hand_limits() const { return dynamics_->hand->limits(); }
void Robot::set_hand(const Eigen::VectorXd& q) { dynamics_->hand->reset(q); }
void Robot::command_hand(const Eigen::VectorXd& targets) { dynamics_->hand->command(targets); }
Eigen::VectorXd Robot::hand_positions() const { return positions(dynamics_->hand->joints()); }
Eigen::VectorXd Robot::hand_velocities() const { return velocities(dynamics_->hand->joints()); }
Eigen::VectorXd Robot::hand_torques() const { return dynamics_->hand->torque(); }

}  // namespace palpate::robot
