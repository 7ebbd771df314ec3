#include "core/control/joint_gate.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "rt/loop/allocation_counter.hpp"

namespace palpate::control {
namespace {

using Joints = kinematics::SerialChain::Joints;
constexpr double kDt = 1e-3;

JointLimits three_joints() {
  JointLimits limits;
  limits.lower = Joints::Constant(3, -1);
  limits.upper = Joints::Constant(3, 1);
  limits.speed = Joints::Constant(3, 0.5);
  limits.acceleration = Joints::Constant(3, 4);
  return limits;
}

/// A table that slides along x, y and z by its joints, in front of distant walls.
class SlidingTable : public ::testing::Test {
 protected:
  SlidingTable() {
    joints_.q = joints_.requested = Joints::Zero(3);
    joints_.J_W_E.setZero(6, 3);
    joints_.J_W_E.topRows<3>().setIdentity();
    inputs_.dt = kDt;
    inputs_.active = true;
  }
  static GateLimits wide() {
    GateLimits limits;
    limits.linear_speed = 1;
    limits.linear_acceleration = 10;
    limits.workspace_lower.setConstant(-5);
    limits.workspace_upper.setConstant(5);
    return limits;
  }
  GateOutput tick() {
    inputs_.X_WE.translation() = joints_.q;
    const GateOutput output = gate_.apply(joints_, inputs_, hand_);
    joints_.q += kDt * output.joint_velocity;
    return output;
  }
  JointGate gate_{three_joints()};
  SafetyGate hand_{wide()};
  JointGateInputs joints_;
  GateInputs inputs_;
};

TEST_F(SlidingTable, PassesWhatKeepsEveryLimit) {
  joints_.requested << 0.002, -0.001, 0.003;
  const GateOutput output = tick();
  EXPECT_EQ(output.joint_velocity, joints_.requested);
  EXPECT_EQ(output.V_W_E.linear, Eigen::Vector3d(joints_.requested));
  EXPECT_FALSE(output.limited);
}

TEST_F(SlidingTable, KeepsSpeedAccelerationAndPositionOfEveryJoint) {
  joints_.requested << 3, 0.2, -0.1;
  Joints before = Joints::Zero(3);
  double fastest = 0;
  for (int i = 0; i < 6000; ++i) {
    const GateOutput output = tick();
    const Joints& v = output.joint_velocity;
    EXPECT_TRUE(output.limited);
    EXPECT_LE(v.cwiseAbs().maxCoeff(), 0.5 * (1 + 1e-12));
    EXPECT_LE((v - before).cwiseAbs().maxCoeff(), 4 * kDt * (1 + 1e-9));
    EXPECT_LE(joints_.q.cwiseAbs().maxCoeff(), 1.0);
    fastest = std::max(fastest, v[0]);
    before = v;
  }
  EXPECT_NEAR(fastest, 0.5, 1e-9);
  EXPECT_GT(joints_.q[0], 0.99) << "up to its end";
}

TEST_F(SlidingTable, TheHandKeepsItsSpeedAndWorkspace) {
  GateLimits limits = wide();
  limits.linear_speed = 0.1;
  limits.workspace_upper.y() = 0.3;
  hand_ = SafetyGate(limits);
  joints_.requested << 0.0, 0.4, 0.3;
  for (int i = 0; i < 5000; ++i) {
    const GateOutput output = tick();
    EXPECT_LE(output.V_W_E.linear.norm(), 0.1 * (1 + 1e-6));
    EXPECT_LE(joints_.q.y(), 0.3 + 1e-9);
  }
  EXPECT_GT(joints_.q.y(), 0.29);
}

TEST_F(SlidingTable, WhatIsNotFiniteOrNotActiveRampsToZeroWithinATenthOfASecond) {
  const auto run_up = [&] {
    joints_.q.setZero();
    inputs_.active = true;
    joints_.requested << 0.4, 0, 0.1;
    for (int i = 0; i < 200; ++i) tick();
  };
  const auto expect_stop = [&](bool refused) {
    for (int i = 0; i < 100; ++i) {
      const GateOutput output = tick();
      EXPECT_EQ(output.rejected, refused);
      EXPECT_TRUE(output.joint_velocity.allFinite());
      if (i < 50) {
        EXPECT_GT(output.joint_velocity[0], 0) << "no sudden stop";
      }
    }
    const GateOutput output = tick();
    EXPECT_EQ(output.joint_velocity.norm(), 0);
    EXPECT_EQ(output.V_W_E.vector().norm(), 0);
  };
  run_up();
  joints_.requested[1] = std::numeric_limits<double>::quiet_NaN();
  expect_stop(true);
  run_up();
  inputs_.active = false;
  expect_stop(false);
  run_up();
  joints_.J_W_E.resize(6, 0);  // unknown
  expect_stop(true);
}

TEST_F(SlidingTable, RefusesWhileTheForceIsTooHigh) {
  joints_.requested << 0.1, 0, 0;
  inputs_.wrench_valid = true;
  inputs_.contact.force << 11, 0, 0;
  const GateOutput output = tick();
  EXPECT_TRUE(output.rejected);
  EXPECT_EQ(output.joint_velocity.norm(), 0);
}

// The hand moves by a twist, then joints are commanded: they continue from the hand's current pose.
TEST_F(SlidingTable, TakesOverFromATwist) {
  inputs_.requested_W_E.linear << 0.3, 0, 0;
  for (int i = 0; i < 300; ++i) hand_.apply(inputs_);
  gate_.pass();
  joints_.requested << 0.3, 0, 0;
  EXPECT_NEAR(tick().joint_velocity[0], 0.3, 1e-5);
}

TEST_F(SlidingTable, AllocatesNothing) {
  joints_.requested << 3, 0.2, -0.1;
  const loop::NoAllocationScope scope;
  for (int i = 0; i < 10; ++i) gate_.apply(joints_, inputs_, hand_);
  EXPECT_EQ(scope.count(), 0);
}

TEST(JointGate, RejectsLimitsThatMakeNoSense) {
  const auto with = [](auto change) {
    JointLimits limits = three_joints();
    change(limits);
    JointGate gate(limits);
  };
  EXPECT_NO_THROW(with([](JointLimits&) {}));
  EXPECT_THROW(with([](JointLimits& l) { l.upper[1] = -2; }), std::invalid_argument);
  EXPECT_THROW(with([](JointLimits& l) { l.speed[2] = 0; }), std::invalid_argument);
  EXPECT_THROW(with([](JointLimits& l) { l.lower.conservativeResize(2); }), std::invalid_argument);
  EXPECT_THROW(with([](JointLimits& l) { l = JointLimits(); }), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::control
