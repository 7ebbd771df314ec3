#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>

#include "core/control/safety_gate.hpp"

namespace palpate::control {
namespace {

using Eigen::Vector3d;

constexpr double kRounding = 1 + 1e-9;

/// Any double value, with special ones at increased frequency.
rc::Gen<double> any_number() {
  return rc::gen::weightedOneOf<double>(
      {{6, rc::gen::map(rc::gen::inRange(-1000000, 1000001), [](int i) { return i * 1e-6; })},
       {2, rc::gen::arbitrary<double>()},
       {2, rc::gen::element(0.0, -0.0, 1e308, -1e308, 1e-308, 5e-324,
                            std::numeric_limits<double>::infinity(),
                            -std::numeric_limits<double>::infinity(),
                            std::numeric_limits<double>::quiet_NaN())}});
}

rc::Gen<double> reasonable(double lower, double upper) {
  return rc::gen::map(rc::gen::inRange(0, 1000001),
                      [=](int i) { return lower + (upper - lower) * (i * 1e-6); });
}

Vector3d draw(const rc::Gen<double>& gen) { return {*gen, *gen, *gen}; }

GateLimits any_limits() {
  GateLimits limits;
  limits.linear_speed = *reasonable(1e-3, 2);
  limits.angular_speed = *reasonable(1e-3, 3);
  limits.linear_acceleration = *reasonable(1e-2, 20);
  limits.angular_acceleration = *reasonable(1e-2, 20);
  limits.force = *reasonable(0.1, 100);
  limits.torque = *reasonable(0.1, 100);
  limits.workspace_lower = draw(reasonable(-2, 0));
  limits.workspace_upper = limits.workspace_lower + draw(reasonable(1e-3, 2));
  return limits;
}

RC_GTEST_PROP(SafetyGateProperty, OutputIsFiniteAndWithinLimitsWhateverComesIn, ()) {
  const GateLimits limits = any_limits();
  SafetyGate gate(limits);
  math::Twist last;
  for (int i = 0; i < 30; ++i) {
    GateInputs inputs;
    inputs.dt = *rc::gen::weightedOneOf<double>(
        {{3, rc::gen::just(1e-3)}, {2, reasonable(1e-6, 0.2)}, {1, any_number()}});
    inputs.active = *rc::gen::weightedElement<bool>({{5, true}, {1, false}});
    const bool wild = *rc::gen::weightedElement<bool>({{1, true}, {2, false}});
    const rc::Gen<double> number = wild ? any_number() : reasonable(-3, 3);
    inputs.requested_W_E = {draw(number), draw(number)};
    inputs.X_WE.translation() = draw(number);
    inputs.wrench_valid = *rc::gen::arbitrary<bool>();
    inputs.contact = {draw(number), draw(number)};
    const GateOutput output = gate.apply(inputs);

    const math::Twist& V = output.V_W_E;
    RC_ASSERT(V.linear.allFinite() && V.angular.allFinite());
    RC_ASSERT(V.linear.norm() <= limits.linear_speed * kRounding);
    RC_ASSERT(V.angular.norm() <= limits.angular_speed * kRounding);

    const bool stopping = output.rejected || !inputs.active;
    const bool step_known = std::isfinite(inputs.dt) && inputs.dt > 0;
    const double dt = step_known ? inputs.dt : 1e-3;
    const auto reach = [&](double acceleration, double speed) {
      return (stopping ? std::max(acceleration, std::sqrt(3.0) * speed / 0.1) : acceleration) * dt *
             kRounding;
    };
    RC_ASSERT((V.linear - last.linear).norm() <=
              reach(limits.linear_acceleration, limits.linear_speed) + 1e-15);
    RC_ASSERT((V.angular - last.angular).norm() <=
              reach(limits.angular_acceleration, limits.angular_speed) + 1e-15);
    if (stopping) {
      RC_ASSERT(V.linear.norm() <= last.linear.norm() * kRounding);
      RC_ASSERT(V.angular.norm() <= last.angular.norm() * kRounding);
    }
    last = V;
  }
}

RC_GTEST_PROP(SafetyGateProperty, NoHandIsDrivenOutOfTheWorkspace, ()) {
  const GateLimits limits = any_limits();
  SafetyGate gate(limits);
  GateInputs inputs;
  inputs.active = true;
  inputs.dt = *reasonable(1e-4, 1e-2);
  Vector3d share = draw(reasonable(0, 1));
  inputs.X_WE.translation() =
      limits.workspace_lower + share.cwiseProduct(limits.workspace_upper - limits.workspace_lower);
  for (int i = 0; i < 500; ++i) {
    if (i % 50 == 0) {
      inputs.requested_W_E = {draw(reasonable(-5, 5)), draw(reasonable(-5, 5))};
      inputs.active = *rc::gen::weightedElement<bool>({{5, true}, {1, false}});
    }
    inputs.X_WE.translation() += inputs.dt * gate.apply(inputs).V_W_E.linear;
    const Vector3d& p = inputs.X_WE.translation();
    RC_ASSERT(((p - limits.workspace_lower).array() >= -1e-9).all());
    RC_ASSERT(((limits.workspace_upper - p).array() >= -1e-9).all());
  }
}

RC_GTEST_PROP(SafetyGateProperty, AFeasibleRequestPassesInTheEnd, ()) {
  SafetyGate gate{GateLimits()};
  GateInputs inputs;
  inputs.active = true;
  inputs.X_WE.translation() << 0, 0, 0.7;
  inputs.requested_W_E = {draw(reasonable(-0.05, 0.05)), draw(reasonable(-0.25, 0.25))};
  GateOutput output;
  for (int i = 0; i < 500; ++i) output = gate.apply(inputs);
  RC_ASSERT(output.V_W_E.linear == inputs.requested_W_E.linear);
  RC_ASSERT(output.V_W_E.angular == inputs.requested_W_E.angular);
  RC_ASSERT(!output.limited && !output.rejected);
}

}  // namespace
}  // namespace palpate::control
