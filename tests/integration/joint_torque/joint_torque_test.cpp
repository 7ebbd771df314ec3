// The component joint_torque on the arm of palpate-sim: its dynamics against those of DART, and
// contacts of the hand, with friction whose parameters are 2 % off and the noise of the sensors.
#include "core/sensing/joint_torque.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "core/math/random.hpp"
#include "rt/registry/arm_inertia.hpp"
#include "rt/registry/arm_model.hpp"
#include "sim/robot/robot.hpp"
#include "sim/sensors/sensor_suite.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;
using kinematics::ChainDynamics;
using sensing::JointTorque;
using Joints = JointTorque::Joints;

const std::string kUrdf = PALPATE_SOURCE_DIR "/sim/robot/lwr_hand.urdf";
const Vector3d kGravity(0, 0, -9.81);
constexpr double kStep = 1e-3;
const math::Pose kX_ES = math::make_pose(Eigen::Matrix3d::Identity(), {0, 0, 0.04});
constexpr double kCoulomb[7] = {1.5, 1.5, 1, 1, 0.8, 0.5, 0.4};  // N m
constexpr double kViscous[7] = {2, 2, 1.5, 1.5, 1, 0.5, 0.5};    // N m s/rad

Joints ready_pose() {
  Joints q(7);
  q << 0.2, -0.4, 0.1, 1.5, -0.1, 0.35, 0.3;
  return q;
}

ChainDynamics own_dynamics() {
  const kinematics::SerialChain chain = registry::read_urdf(kUrdf, "flange");
  registry::ArmInertia inertia = registry::read_inertia(kUrdf, "flange");
  inertia.links.back() += kinematics::BodyInertia::moved(chain.X_JE(), inertia.load);
  return {chain, inertia.links, kGravity};
}

robot::Robot darts_arm() {
  robot::Robot arm(robot::load_model(kUrdf), robot::RobotOptions());
  arm.set_joints(ready_pose());
  return arm;
}

// DART steps M(q) (dq' - dq) = dt (tau - C dq - g).
TEST(JointTorqueDynamics, AreThoseOfDart) {
  const ChainDynamics dynamics = own_dynamics();
  robot::Robot arm = darts_arm();
  ChainDynamics::State state, plus, minus;
  double largest = 0, fastest = 0;
  for (int k = 0; k < 400; ++k) {
    const Joints q = arm.joint_positions(), dq = arm.joint_velocities();
    Eigen::VectorXd command(7);
    for (int i = 0; i < 7; ++i) command[i] = 0.9 * std::sin(0.02 * k * (1 + 0.2 * i) + i);
    arm.command_joints(command);
    arm.step(kStep);
    dynamics.evaluate(q, dq, state);
    constexpr double kDifference = 1e-5;
    dynamics.evaluate(q + kDifference * dq, dq, plus);
    dynamics.evaluate(q - kDifference * dq, dq, minus);
    const Joints rate = (plus.momentum - minus.momentum) / (2 * kDifference);  // dM/dt dq
    const Joints coriolis = rate - state.coriolis;                             // C dq
    fastest = std::max(fastest, dq.cwiseAbs().maxCoeff());
    const Joints ddq = (arm.joint_velocities() - dq) / kStep;
    dynamics.evaluate(q, ddq, plus);
    const Joints difference = plus.momentum + coriolis + state.gravity - arm.joint_torques();
    largest = std::max(largest, difference.cwiseAbs().maxCoeff());
  }
  EXPECT_GT(fastest, 0.5);
  EXPECT_LT(largest, 1e-5);
  std::printf("largest difference of a joint torque: %.1e N m\n", largest);
}

/// The arm with the sensors of the table and the component that reads them.
class Cell {
 public:
  explicit Cell(std::uint64_t seed)
      : random_(seed, "friction"),
        arm_(darts_arm()),
        sensors_(table(), seed, math::Pose::Identity(), 7),
        model_(own_dynamics(), options()) {}

  /// Moves the hand with `V` (m/s, rad/s, in W), under the force `F_W` on it at 0.3 m beyond E.
  void step(const math::Vector6d& V, const Vector3d& F_W) {
    arm_.set_hand_load({F_W, Vector3d::Zero()}, arm_.flange_pose() * Vector3d(0, 0, 0.3));
    arm_.command_twist(math::Twist::from(V));
    arm_.step(kStep);
    now_us_ += 1000;
    sensors_.sample(now_us_, truth());
    signals_.robot.fresh_count = 0;
    sensors::RobotReading reading;
    while (sensors_.take(now_us_, reading)) feed(reading);
    contacts_.count = 0;
    result_ = model_.update(signals_, contacts_);
    const Eigen::Matrix3d R_WS = arm_.link_pose("sensor").linear();
    if (contacts_.count == 0) return;
    const sensing::Contact& contact = contacts_.contacts[0];
    error_ = R_WS * contact.wrench.force + F_W;  // the component's acts on the object
    const Eigen::Matrix3d P = R_WS * contact.covariance.topLeftCorner<3, 3>() * R_WS.transpose();
    deviation_ = P.diagonal().cwiseSqrt();
    force_ = contact.wrench.force.norm();
  }

  void zero() { model_.zero(); }
  bool is_known() const { return contacts_.count == 1 && result_.is_ok(); }
  const Vector3d& error() const { return error_; }          // N, in W
  const Vector3d& deviation() const { return deviation_; }  // N
  double force() const { return force_; }                   // N

 private:
  static sensors::SensorTable table() {
    std::string friction = "{robot_state: {friction: {coulomb: [";
    for (const double value : kCoulomb) friction += std::to_string(value) + ", ";
    friction += "], viscous: [";
    for (const double value : kViscous) friction += std::to_string(value) + ", ";
    const auto node = config::Node::from_text(friction + "]}}}");
    return sensors::read_sensors(node);
  }

  JointTorque::Options options() {
    JointTorque::Options options;
    options.X_ES = kX_ES;
    options.friction.coulomb = Eigen::Map<const Eigen::Matrix<double, 7, 1>>(kCoulomb);
    options.friction.viscous = Eigen::Map<const Eigen::Matrix<double, 7, 1>>(kViscous);
    options.friction.error = 0.02;
    options.friction.presliding = 3e-4 * (1 + 0.2 * random_.normal());
    for (int i = 0; i < 7; ++i) {
      options.friction.coulomb[i] *= 1 + 0.02 * random_.normal();
      options.friction.viscous[i] *= 1 + 0.02 * random_.normal();
    }
    // as palpate-calibrate friction finds them in free motion
    options.deviation.resize(7);
    options.deviation << 0.17, 0.17, 0.09, 0.09, 0.03, 0.03, 0.02;
    options.model_error = 0;
    return options;
  }

  sensors::Truth truth() const {
    sensors::Truth truth;
    truth.robot.q = arm_.joint_positions();
    truth.robot.dq = arm_.joint_velocities();
    truth.robot.tau = arm_.joint_torques();
    truth.robot.X_WE = arm_.flange_pose();
    truth.robot.V_W_E = arm_.flange_twist();
    truth.jacobian = arm_.flange_jacobian();
    truth.force_torque.wrench.setZero();
    truth.imu.motion.setZero();
    return truth;
  }

  void feed(const sensors::RobotReading& reading) {
    auto& stream = signals_.robot;
    sensing::RobotState& state = stream.latest;
    state.time = 1e-6 * static_cast<double>(reading.time_us);
    state.joint_count = 7;
    state.q.head<7>() = reading.q;
    state.dq.head<7>() = reading.dq;
    state.tau.head<7>() = reading.tau;
    state.X_WE = reading.X_WE;
    stream.fresh[stream.fresh_count++] = state;
    stream.freshness = Freshness::kNew;
    stream.age = 0;
  }

  math::Random random_;
  robot::Robot arm_;
  sensors::SensorSuite sensors_;
  JointTorque model_;
  sensing::Signals signals_;
  sensing::ContactSet contacts_;
  UpdateResult result_;
  std::int64_t now_us_ = 0;
  Vector3d error_ = Vector3d::Zero(), deviation_ = Vector3d::Zero();
  double force_ = 0;
};

/// Slow motion to and fro that turns each joint.
math::Vector6d wandering(double time) {
  math::Vector6d V;
  for (int i = 0; i < 6; ++i)
    V[i] = (i < 3 ? 0.05 : 0.15) * std::sin(2 * M_PI * time / (3 + 0.7 * i) + 1.3 * i);
  return V;
}

struct Scores {
  std::vector<double> relative;  // RMS error of each contact over its peak
  double weakest = 1e9;          // N, least force found at the peak of a contact of 2 N
  double idle = 0;               // N, largest without contact
  int inside = 0, count = 0;     // of the 95 % intervals, by axis, every 50 ms
};

/// `move`: whether the hand moves while it touches.
void run(std::uint64_t seed, bool move, Scores& scores) {
  constexpr double kContact = 1, kBetween = 0.5;
  Cell cell(seed);
  math::Random random(seed, "contacts");
  double time = 0;
  const auto go = [&](double seconds, bool moves, const Vector3d& peak, auto&& judge) {
    for (int k = 0; k < std::lround(seconds / kStep); ++k) {
      const double share = std::sin(M_PI * k * kStep / seconds);
      const math::Vector6d V = moves ? wandering(time) : math::Vector6d::Zero();
      cell.step(V, share * share * peak);
      time += kStep;
      ASSERT_TRUE(cell.is_known());
      judge(share);
      if (k % 50 != 0) continue;
      for (int axis = 0; axis < 3; ++axis) {
        scores.inside += std::abs(cell.error()[axis]) < 1.96 * cell.deviation()[axis] ? 1 : 0;
        ++scores.count;
      }
    }
  };
  const Vector3d none = Vector3d::Zero();
  const auto ignore = [](double) {};
  cell.step(math::Vector6d::Zero(), none);
  for (int k = 0; k < 10; ++k) cell.step(math::Vector6d::Zero(), none);
  go(4, true, none, ignore);
  for (const double peak : {2.0, 5.0, 10.0, 20.0}) {
    go(kBetween, move, none, ignore);
    go(kBetween, move, none, [&](double) { scores.idle = std::max(scores.idle, cell.force()); });
    const Vector3d towards =
        Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    double sum = 0, found = 0;
    int count = 0;
    go(kContact, move, peak * towards, [&](double share) {
      sum += cell.error().squaredNorm();
      ++count;
      if (share > 0.95) found = std::max(found, cell.force());
    });
    if (peak > 2) scores.relative.push_back(std::sqrt(sum / count) / peak);
    if (peak == 2) scores.weakest = std::min(scores.weakest, found);
  }
}

TEST(JointTorque, FindsContactsWithFrictionAndNoise) {
  for (const bool move : {false, true}) {
    Scores scores;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) run(seed, move, scores);
    const double rms = std::sqrt(std::inner_product(scores.relative.begin(), scores.relative.end(),
                                                    scores.relative.begin(), 0.0) /
                                 static_cast<double>(scores.relative.size()));
    const double worst = *std::max_element(scores.relative.begin(), scores.relative.end());
    const double inside = static_cast<double>(scores.inside) / scores.count;
    std::printf(
        "%s: RMS error %.1f %% of the peak, worst contact %.1f %%; 2 N found as at least %.2f N, "
        "without contact at most %.2f N; %.1f %% of the 95 %% intervals hold\n",
        move ? "moving" : "at rest", 100 * rms, 100 * worst, scores.weakest, scores.idle,
        100 * inside);
    EXPECT_LT(rms, 0.1);
    EXPECT_GT(scores.weakest, scores.idle);
    EXPECT_GT(inside, 0.9);
  }
}

}  // namespace
}  // namespace palpate
