#include <gtest/gtest.h>

#include <limits>

#include "core/control/safety_gate.hpp"

namespace palpate::control {
namespace {

using Eigen::Vector3d;

GateInputs request(const Vector3d& linear, const Vector3d& angular = Vector3d::Zero()) {
  GateInputs inputs;
  inputs.active = true;
  inputs.requested_W_E = {linear, angular};
  inputs.X_WE.translation() << 0.2, 0, 0.5;
  return inputs;
}

GateOutput repeat(SafetyGate& gate, const GateInputs& inputs, int times) {
  GateOutput output;
  for (int i = 0; i < times; ++i) output = gate.apply(inputs);
  return output;
}

TEST(SafetyGate, LetsASmallRequestThroughOnceItHasAccelerated) {
  SafetyGate gate{GateLimits()};
  const GateInputs inputs = request({0.03, 0.02, -0.01}, {0.1, 0, 0.2});
  const GateOutput first = gate.apply(inputs);
  EXPECT_NEAR(first.V_W_E.linear.norm(), 0.5e-3, 1e-12);
  EXPECT_NEAR(first.V_W_E.angular.norm(), 2e-3, 1e-12);
  EXPECT_TRUE(first.limited);
  EXPECT_STREQ(first.reason, "acceleration");
  const GateOutput later = repeat(gate, inputs, 200);
  EXPECT_EQ(later.V_W_E.linear, inputs.requested_W_E.linear);
  EXPECT_EQ(later.V_W_E.angular, inputs.requested_W_E.angular);
  EXPECT_FALSE(later.limited);
  EXPECT_FALSE(later.rejected);
}

TEST(SafetyGate, ScalesTheWholeTwist) {
  SafetyGate gate{GateLimits()};
  const GateOutput output = repeat(gate, request({0.3, 0.4, 0}, {0, 0, 1}), 1000);
  EXPECT_LT((output.V_W_E.linear - Vector3d(0.06, 0.08, 0)).norm(), 1e-12);
  EXPECT_LT((output.V_W_E.angular - Vector3d(0, 0, 0.2)).norm(), 1e-12);
  EXPECT_STREQ(output.reason, "speed");
}

TEST(SafetyGate, StopsBeforeTheWallAndComesBack) {
  const GateLimits limits;
  SafetyGate gate(limits);
  GateInputs inputs = request({0.08, 0.05, 0.03});
  for (int i = 0; i < 40000; ++i) {
    inputs.X_WE.translation() += inputs.dt * gate.apply(inputs).V_W_E.linear;
    ASSERT_TRUE((inputs.X_WE.translation().array() <= limits.workspace_upper.array()).all());
  }
  EXPECT_LT((inputs.X_WE.translation() - limits.workspace_upper).norm(), 1e-3);
  inputs.requested_W_E.linear = -inputs.requested_W_E.linear;
  EXPECT_EQ(repeat(gate, inputs, 1000).V_W_E.linear, inputs.requested_W_E.linear);
}

TEST(SafetyGate, OutsideTheWorkspaceOnlyTheWayBackIsOpen) {
  SafetyGate gate{GateLimits()};
  GateInputs inputs = request({0.05, 0, 0.02});
  inputs.X_WE.translation() << 1.3, 0, 0.5;
  GateOutput output = repeat(gate, inputs, 1000);
  EXPECT_EQ(output.V_W_E.linear.x(), 0);
  EXPECT_EQ(output.V_W_E.linear.z(), 0.02);
  EXPECT_STREQ(output.reason, "workspace");
  inputs.requested_W_E.linear.x() = -0.05;
  EXPECT_EQ(repeat(gate, inputs, 1000).V_W_E.linear.x(), -0.05);
}

TEST(SafetyGate, InactiveIsAtRestWithin100Milliseconds) {
  SafetyGate gate{GateLimits()};
  GateInputs inputs = request({0.1, 0, 0}, {0.5, 0, 0});
  repeat(gate, inputs, 1000);
  inputs.active = false;
  double speed = 0.1;
  for (int i = 0; i < 100; ++i) {
    const double next = gate.apply(inputs).V_W_E.linear.norm();
    EXPECT_LE(next, speed);
    EXPECT_GT(next, speed - 2e-3);  // a ramp, not a step
    speed = next;
  }
  const GateOutput output = gate.apply(inputs);
  EXPECT_EQ(output.V_W_E.vector().norm(), 0);
  EXPECT_FALSE(output.rejected);
}

TEST(SafetyGate, RejectsWhileForceOrTorqueIsTooHigh) {
  SafetyGate gate{GateLimits()};
  GateInputs inputs = request({0.1, 0, 0});
  inputs.wrench_valid = true;
  inputs.contact.force << 0, 0, 9.9;
  EXPECT_FALSE(repeat(gate, inputs, 1000).rejected);
  inputs.contact.force << 0, 0, 10.1;
  GateOutput output = repeat(gate, inputs, 101);
  EXPECT_TRUE(output.rejected);
  EXPECT_EQ(output.V_W_E.vector().norm(), 0);
  EXPECT_STREQ(output.reason, "contact force or torque is above its limit");
  inputs.contact.force << 0, 0, 9.5;  // not yet
  EXPECT_TRUE(gate.apply(inputs).rejected);
  inputs.wrench_valid = false;  // and not because inputs are missing
  EXPECT_TRUE(gate.apply(inputs).rejected);
  inputs.wrench_valid = true;
  inputs.contact.force << 0, 0, 8.9;
  EXPECT_FALSE(gate.apply(inputs).rejected);
  inputs.contact.torque << 3.1, 0, 0;
  EXPECT_TRUE(gate.apply(inputs).rejected);
  inputs.contact.torque << std::numeric_limits<double>::quiet_NaN(), 0, 0;
  EXPECT_TRUE(gate.apply(inputs).rejected);
}

TEST(SafetyGate, RejectsNonsenseAndRampsDown) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  SafetyGate gate{GateLimits()};
  const GateInputs good = request({0.1, 0, 0});
  const double before = repeat(gate, good, 1000).V_W_E.linear.x();
  GateInputs bad = good;
  bad.requested_W_E.angular.y() = nan;
  GateOutput output = gate.apply(bad);
  EXPECT_TRUE(output.rejected);
  EXPECT_LT(output.V_W_E.linear.x(), before);
  EXPECT_GT(output.V_W_E.linear.x(), 0);
  bad = good;
  bad.X_WE.matrix()(1, 3) = nan;
  EXPECT_TRUE(gate.apply(bad).rejected);
  bad = good;
  bad.dt = -1;
  EXPECT_TRUE(gate.apply(bad).rejected);
}

TEST(SafetyGate, AnOverloadIsForgottenWithoutAStepOfTheCommand) {
  const GateLimits limits;
  SafetyGate gate{limits};
  GateInputs inputs = request({0.1, 0, 0});
  repeat(gate, inputs, 1000);
  inputs.wrench_valid = true;
  inputs.contact.force.x() = 1.01 * limits.force;
  const double braking = gate.apply(inputs).V_W_E.linear.x();
  inputs.contact.force.x() = 0.95 * limits.force;  // not below the release threshold
  EXPECT_TRUE(gate.apply(inputs).rejected);
  gate.forget_overload();
  const GateOutput output = gate.apply(inputs);
  EXPECT_FALSE(output.rejected);
  EXPECT_GT(output.V_W_E.linear.x(), 0.5 * braking);
}

TEST(SafetyGate, RejectsBadLimits) {
  GateLimits limits;
  limits.linear_speed = 0;
  EXPECT_THROW(SafetyGate{limits}, std::invalid_argument);
  limits = GateLimits();
  limits.torque = std::numeric_limits<double>::infinity();
  EXPECT_THROW(SafetyGate{limits}, std::invalid_argument);
  limits = GateLimits();
  limits.workspace_lower.x() = 2;
  EXPECT_THROW(SafetyGate{limits}, std::invalid_argument);
}

}  // namespace
}  // namespace palpate::control
