#include "core/sensing/joint_torque.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "rt/loop/allocation_counter.hpp"
#include "wrist_signals.hpp"

namespace palpate::sensing {
namespace {

using Joints = JointTorque::Joints;
using Eigen::Vector3d;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kLength = 0.5, kStep = 2e-3;

// Gantry of three prismatic joints along x, y and z with a wrist of three hinges: the Jacobian is
// known, and every wrench is determined.
kinematics::ChainDynamics gantry() {
  std::vector<kinematics::Joint> joints(6);
  for (int i = 0; i < 6; ++i) {
    joints[i].name = std::to_string(i);
    joints[i].axis_J = Vector3d::Unit(i % 3);
    joints[i].revolute = i >= 3;
    joints[i].lower = -3;
    joints[i].upper = 3;
    joints[i].speed = 1;
  }
  math::Pose X_JE = math::Pose::Identity();
  X_JE.translation() = Vector3d(kLength, 0, 0);
  std::vector<kinematics::BodyInertia> links(6);
  links[5] = {2, Vector3d(0.2, 0, 0), 0.1 * Eigen::Matrix3d::Identity()};
  return {{joints, X_JE}, links, {0, 0, -9.81}};
}

JointTorque::Options options() {
  JointTorque::Options options;
  options.friction = {Joints::Zero(6), Joints::Zero(6), 1e-3, 0.1};
  options.deviation = Joints::Constant(6, 0.1);
  options.model_error = 0;
  return options;
}

/// Load in the gantry's own directions, about the hinges: torques that hold 2 kg and resist F.
RobotState at_rest(double time, const math::Vector6d& on_hand) {
  RobotState state;
  state.time = time;
  state.joint_count = 6;
  math::Vector6d at_hinge = on_hand;
  at_hinge.tail<3>() += Vector3d(kLength, 0, 0).cross(on_hand.head<3>());
  state.tau.head<6>() << 0, 0, 2 * 9.81, 0, -0.2 * 9.81, 0;
  state.tau.head<6>() -= at_hinge;
  return state;
}

class Sensor {
 public:
  explicit Sensor(const JointTorque::Options& options = sensing::options())
      : model(gantry(), options) {}

  const UpdateResult& update(const RobotState& state) {
    feed(signals.robot, state);
    contacts.count = 0;
    return result = model.update(signals, contacts);
  }
  /// For `seconds` with this wrench on the hand.
  const UpdateResult& rest(double seconds, const math::Vector6d& on_hand) {
    for (int i = 0; i < seconds / kStep; ++i) update(at_rest(time += kStep, on_hand));
    return result;
  }
  math::Vector6d wrench() const { return contacts.contacts[0].wrench.vector(); }

  JointTorque model;
  UpdateResult result;
  Signals signals;
  ContactSet contacts;
  double time = 1;
};

math::Vector6d six(double fx, double fy, double fz, double tx, double ty, double tz) {
  return (math::Vector6d() << fx, fy, fz, tx, ty, tz).finished();
}

TEST(JointTorque, FindsTheWrenchOnTheHandAndItsOppositeIsOnTheObject) {
  Sensor sensor;
  const math::Vector6d on_hand = six(5, -3, 8, 0.3, -0.2, 0.1);
  EXPECT_TRUE(sensor.rest(0.5, on_hand).is_ok());
  ASSERT_EQ(sensor.contacts.count, 1);
  EXPECT_EQ(sensor.contacts.contacts[0].source, Source::kWrist0);
  EXPECT_LT((sensor.wrench() + on_hand).norm(), 1e-3);
}

TEST(JointTorque, TheBandwidthIsThatOfAFirstOrderFilter) {
  Sensor sensor;
  sensor.rest(0.2, math::Vector6d::Zero());
  sensor.rest(1 / (2 * M_PI * 10), six(10, 0, 0, 0, 0, 0));
  EXPECT_NEAR(-sensor.wrench()[0], 10 * (1 - std::exp(-1)), 0.6);
}

TEST(JointTorque, ACovarianceIsThatOfTheJointsThroughTheJacobian) {
  Sensor sensor;
  sensor.rest(0.1, math::Vector6d::Zero());
  const math::Matrix6d& P = sensor.contacts.contacts[0].covariance;
  EXPECT_NEAR(std::sqrt(P(0, 0)), 0.1, 1e-4);
  // force along y by the prismatic joint; torque about z by the hinge and the lever
  EXPECT_NEAR(std::sqrt(P(5, 5)), 0.1 * std::hypot(1, kLength), 1e-4);
  EXPECT_LT(P(1, 5), 0);
}

TEST(JointTorque, AWeakDirectionHasALargeDeviationAndNoForce) {
  // all hinges of the wrist in a plane: nothing resists a torque about the third axis
  JointTorque::Options weak = options();
  weak.deviation[0] = 1e4;
  Sensor sensor(weak);
  sensor.rest(0.5, six(5, 4, 0, 0, 0, 0));
  EXPECT_LT(std::abs(sensor.wrench()[0]), 0.1);
  EXPECT_NEAR(sensor.wrench()[1], -4, 0.01);
  EXPECT_GT(std::sqrt(sensor.contacts.contacts[0].covariance(0, 0)), 90);
  EXPECT_GT(sensor.contacts.contacts[0].force_deviation, 50);
}

TEST(JointTorque, ATareRemovesOffsetsAndNothingElse) {
  Sensor sensor;
  sensor.rest(0.3, six(1, 2, 3, 0.1, 0.2, 0.3));
  sensor.model.zero();
  sensor.rest(500 * kStep, six(1, 2, 3, 0.1, 0.2, 0.3));
  EXPECT_LT(sensor.wrench().norm(), 1e-3);
  sensor.rest(0.5, six(6, 2, 3, 0.1, 0.2, 0.3));
  EXPECT_LT((sensor.wrench() + six(5, 0, 0, 0, 0, 0)).norm(), 1e-3);
  // a replacement continues with it
  Sensor next;
  EXPECT_TRUE(next.model.restore(sensor.model.save()));
  next.time = sensor.time;
  next.rest(0.5, six(1, 2, 3, 0.1, 0.2, 0.3));
  EXPECT_LT(next.wrench().norm(), 1e-3);
}

TEST(JointTorque, BadReadingsAreCountedAndDegradeAfterAWhile) {
  Sensor sensor;
  EXPECT_EQ(sensor.model.update(sensor.signals, sensor.contacts).status, Status::kDegraded);
  sensor.rest(0.1, six(5, 0, 0, 0, 0, 0));
  RobotState bad = at_rest(sensor.time += kStep, math::Vector6d::Zero());
  bad.tau[2] = kNan;
  EXPECT_TRUE(sensor.update(bad).is_ok());  // one is no failure
  EXPECT_EQ(sensor.model.skipped(), 1);
  const auto fails_with = [&](const RobotState& state, const std::string& part) {
    UpdateResult result;
    for (int i = 0; i < 50; ++i) result = sensor.update(state);
    EXPECT_EQ(result.status, Status::kDegraded);
    EXPECT_NE(std::string(result.reason).find(part), std::string::npos) << result.reason;
    EXPECT_EQ(sensor.contacts.count, 0);
    EXPECT_TRUE(sensor.rest(0.1, math::Vector6d::Zero()).is_ok());
  };
  fails_with(bad, "not finite");
  RobotState few = at_rest(sensor.time, math::Vector6d::Zero());
  few.joint_count = 5;
  fails_with(few, "number of joints");
  RobotState silent = at_rest(sensor.time, math::Vector6d::Zero());
  silent.tau.setZero();
  fails_with(silent, "reports no joint torques");
  EXPECT_EQ(sensor.model.skipped(), 151);
  sensor.signals.robot.fresh_count = 0;
  sensor.signals.robot.age = 0.03;
  sensor.contacts.count = 0;
  EXPECT_EQ(sensor.model.update(sensor.signals, sensor.contacts).status, Status::kDegraded);
  EXPECT_EQ(sensor.contacts.count, 0);
}

TEST(JointTorque, AJumpOfTheSendersClockDoesNotDisturbTheWrench) {
  Sensor sensor;
  sensor.rest(0.5, six(5, 0, 0, 0, 0, 0));
  sensor.time -= 100;
  sensor.rest(0.01, six(5, 0, 0, 0, 0, 0));
  EXPECT_NEAR(sensor.wrench()[0], -5, 1e-3);
}

TEST(JointTorque, ExternalTorquesAreUsedAsTheyAre) {
  JointTorque::Options external = options();
  external.external = true;
  external.polarity = -1;
  Sensor sensor(external);
  for (int i = 0; i < 200; ++i) {
    RobotState state = at_rest(sensor.time += kStep, six(0, 7, 0, 0, 0, 0));
    state.tau.head<6>() -= at_rest(0, math::Vector6d::Zero()).tau.head<6>();  // of the drives
    EXPECT_TRUE(sensor.update(state).is_ok());
  }
  EXPECT_LT((sensor.wrench() + six(0, 7, 0, 0, 0, 0)).norm(), 1e-3);
}

TEST(JointTorque, DoesNotAllocate) {
  Sensor sensor;
  sensor.model.zero();
  const RobotState state = at_rest(1, six(1, 0, 0, 0, 0, 0));
  const loop::NoAllocationScope scope;
  sensor.update(state);
  sensor.model.reset();
  EXPECT_EQ(scope.count(), 0);
}

TEST(JointTorque, RefusesOptionsThatCannotBe) {
  const auto with = [](auto change) {
    JointTorque::Options changed = options();
    change(changed);
    JointTorque(gantry(), changed);
  };
  EXPECT_NO_THROW(with([](auto&) {}));
  EXPECT_THROW(with([](auto& o) { o.deviation.setZero(); }), std::invalid_argument);
  EXPECT_THROW(with([](auto& o) { o.deviation.resize(5); }), std::invalid_argument);
  EXPECT_THROW(with([](auto& o) { o.friction.coulomb[2] = -1; }), std::invalid_argument);
  EXPECT_THROW(with([](auto& o) { o.bandwidth = 0; }), std::invalid_argument);
  EXPECT_THROW(with([](auto& o) { o.polarity = 0; }), std::invalid_argument);
}

JointFriction friction() {
  return JointFriction({Joints::Constant(1, 2.0), Joints::Constant(1, 0.5), 1e-3, 0.1});
}

Joints one(double value) { return Joints::Constant(1, value); }

TEST(JointFriction, IsKnownOnceTheJointHasMovedAndStaysAtRest) {
  JointFriction joint = friction();
  joint.follow(one(0.3), one(0));
  EXPECT_FALSE(joint.is_known());
  EXPECT_EQ(joint.torque()[0], 0);
  EXPECT_GT(joint.deviation()[0], 2 / std::sqrt(3.0));
  joint.follow(one(0.305), one(0.4));
  EXPECT_TRUE(joint.is_known());
  EXPECT_NEAR(joint.torque()[0], 2 + 0.5 * 0.4, 1e-12);
  EXPECT_NEAR(joint.deviation()[0], 0.1 * 2.2, 1e-12);
  for (int i = 0; i < 100; ++i) joint.follow(one(0.305), one(0));
  EXPECT_NEAR(joint.torque()[0], 2, 1e-12);
  for (const double x : {0.2, 0.5, 1.0, 2.0, 4.0}) {  // turns back
    joint.follow(one(0.305 - 1e-3 * x), one(0));
    EXPECT_NEAR(joint.torque()[0], 2 * (2 * std::exp(-x) - 1), 2 * 0.07) << x;
  }
  joint.reset();
  joint.follow(one(0.304), one(0));
  EXPECT_FALSE(joint.is_known());
}

TEST(JointTorque, ATareWaitsUntilFrictionIsKnown) {
  JointTorque::Options with_friction = options();
  with_friction.tare_at_start = true;
  with_friction.friction.coulomb = Joints::Constant(6, 1.0);
  Sensor sensor(with_friction);
  UpdateResult result = sensor.rest(2, math::Vector6d::Zero());
  EXPECT_NE(std::string(result.reason).find("has moved"), std::string::npos) << result.reason;
  RobotState moved = at_rest(sensor.time, math::Vector6d::Zero());
  for (int i = 0; i < 600; ++i) {
    moved.time += kStep;
    moved.q.head<6>().setConstant(0.01 * std::min(1.0, i / 50.0));
    moved.tau.head<6>() =
        at_rest(0, math::Vector6d::Zero()).tau.head<6>() + math::Vector6d::Ones();  // of friction
    result = sensor.update(moved);
  }
  EXPECT_TRUE(result.is_ok()) << result.reason;
  EXPECT_LT(sensor.wrench().norm(), 0.1);
}

}  // namespace
}  // namespace palpate::sensing
