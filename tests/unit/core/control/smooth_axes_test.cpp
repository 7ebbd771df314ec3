// Commands with limited jerk: SmoothAxes, and the gate that contains them.
#include "core/control/smooth_axes.hpp"

#include <gtest/gtest.h>

#include "core/control/safety_gate.hpp"
#include "core/math/random.hpp"

namespace palpate::control {
namespace {

using Eigen::Vector3d;

constexpr double kCycle = 1e-3;
constexpr double kRounding = 1 + 1e-9;

/// Observes a sequence of velocities for their limits.
struct Observer {
  void take(const Vector3d& v) {
    const Vector3d a = (v - v_) / kCycle;
    speed = std::max(speed, v.norm());
    acceleration = std::max(acceleration, a.norm());
    jerk = std::max(jerk, (a - a_).norm() / kCycle);
    v_ = v;
    a_ = a;
  }
  double speed = 0, acceleration = 0, jerk = 0;

 private:
  Vector3d v_ = Vector3d::Zero(), a_ = Vector3d::Zero();
};

TEST(AxisMotion, ReachesAVelocityAsTheSCurveOfItsLimitsDoes) {
  // v / A + A / J s where the acceleration reaches its limit, 2 sqrt(v / J) where it does not.
  const math::AxisLimits limits{0.5, 10};
  for (const auto& [goal, seconds] : {std::pair{0.2, 0.45}, std::pair{0.01, 0.0632455532}}) {
    double v = 0, a = 0;
    int steps = 0;
    while (v != goal && steps < 1000) {
      EXPECT_GE(math::coasting_velocity(v, a, limits, kCycle), v - 1e-15);
      EXPECT_LE(math::coasting_velocity(v, a, limits, kCycle), goal + 1e-12);
      a = math::acceleration_towards(goal - v, a, limits, kCycle);
      v += a * kCycle;
      ++steps;
      if (std::abs(v - goal) < 1e-12) v = goal;
    }
    EXPECT_NEAR(steps * kCycle, seconds, 3 * kCycle) << goal;
    EXPECT_NEAR(a, 0, limits.jerk * kCycle * kRounding) << "arrives without a jolt";
  }
}

TEST(AxisMotion, BrakingDistanceIsThatOfTheMotion) {
  const math::AxisLimits limits{0.5, 10};
  for (const double v0 : {0.002, 0.05, 0.3})
    for (const double a0 : {-0.1, 0.0, 0.1, 0.5}) {
      if (v0 + a0 * std::abs(a0) / (2 * limits.jerk) <= 0) {
        EXPECT_EQ(math::braking_distance(v0, a0, limits), 0);
        continue;
      }
      constexpr double kFine = 1e-6;
      double v = v0, a = a0, way = 0;
      for (int i = 0; i < 2'000'000 && (std::abs(v) > 1e-9 || std::abs(a) > 1e-4); ++i) {
        a = math::acceleration_towards(-v, a, limits, kFine);
        v += a * kFine;
        way += v * kFine;
      }
      EXPECT_NEAR(math::braking_distance(v0, a0, limits), way, 2e-6) << v0 << " " << a0;
    }
}

TEST(SmoothAxes, NeverExceedSpeedAccelerationAndJerkWhateverTheGoals) {
  const SmoothLimits limits{0.1, 0.5, 5};
  math::Random random(1);
  SmoothAxes axes(limits);
  Observer observer;
  Vector3d v = Vector3d::Zero(), goal = Vector3d::Zero();
  bool at_wall = false;
  for (int i = 0; i < 60'000; ++i) {
    if (random.uniform(0, 1) < (i < 30'000 ? 0.5 : 0.01))
      goal = limits.speed * random.uniform(0.2, 1) *
             Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    v = axes.advance(v, goal, v, {}, kCycle, at_wall);
    observer.take(v);
  }
  EXPECT_LE(observer.speed, limits.speed * kRounding);
  EXPECT_LE(observer.acceleration, limits.acceleration * kRounding);
  EXPECT_LE(observer.jerk, limits.jerk * (1 + 1e-6));
  EXPECT_GT(observer.speed, 0.9 * limits.speed) << "and are of use";
  EXPECT_FALSE(at_wall);
}

TEST(SmoothAxes, StopBeforeWallsWithinTheLimitOfJerk) {
  const SmoothLimits limits{0.3, 0.5, 5};
  math::Random random(2);
  for (int run = 0; run < 20; ++run) {
    SmoothAxes axes(limits);
    Observer observer;
    Vector3d v = Vector3d::Zero(), p = Vector3d::Zero(), goal = Vector3d::Zero();
    double beyond = 0, nearest = 1;
    for (int i = 0; i < 8'000; ++i) {
      if (i % 1'600 == 0)
        goal =
            limits.speed * Vector3d(random.normal(), random.normal(), random.normal()).normalized();
      bool at_wall = false;
      const Room room{p.array() + 0.1, 0.1 - p.array()};
      v = axes.advance(v, goal, Vector3d::Constant(1e3), room, kCycle, at_wall);
      p += kCycle * v;
      observer.take(v);
      beyond = std::max(beyond, p.cwiseAbs().maxCoeff() - 0.1);
      nearest = std::min(nearest, 0.1 - p.cwiseAbs().maxCoeff());
    }
    EXPECT_LE(beyond, 0) << run;
    EXPECT_LT(nearest, 2e-3) << "the box is of use";
    EXPECT_LE(observer.jerk, limits.jerk * (1 + 1e-6)) << run;
    EXPECT_LE(observer.acceleration, limits.acceleration * kRounding);
    EXPECT_LE(observer.speed, limits.speed * kRounding);
  }
}

class JerkLimitedGate : public ::testing::Test {
 protected:
  static GateLimits smooth() {
    GateLimits limits;
    limits.linear_jerk = 5;
    limits.angular_jerk = 20;
    return limits;
  }
  GateInputs inputs() const {
    GateInputs inputs;
    inputs.dt = kCycle;
    inputs.active = true;
    inputs.requested_W_E = {{0.08, 0, 0.03}, {0, 0.4, 0}};
    inputs.X_WE.translation() << 0.5, 0, 0.5;
    return inputs;
  }
  SafetyGate gate_{smooth()}, plain_{GateLimits{}};
};

TEST_F(JerkLimitedGate, AStopIsAsSoonAsWithoutAJerkLimit) {
  for (const bool rejects : {false, true}) {
    for (int i = 0; i < 1000; ++i) {
      gate_.apply(inputs());
      plain_.apply(inputs());
    }
    ASSERT_LT((gate_.last().vector() - plain_.last().vector()).norm(), 1e-12);
    GateInputs stop = inputs();
    stop.active = rejects;
    stop.requested_W_E.linear.x() = rejects ? std::nan("") : 0.08;
    for (int i = 0; i < 100; ++i) {
      const math::Twist V = gate_.apply(stop).V_W_E;
      EXPECT_LT((V.vector() - plain_.apply(stop).V_W_E.vector()).norm(), 1e-12) << i;
    }
    EXPECT_EQ(gate_.last().vector().norm(), 0) << "within 100 ms";
  }
}

TEST_F(JerkLimitedGate, LimitsBothPartsOfTheTwistAndSaysSo) {
  Observer linear, angular;
  GateOutput output;
  math::Random random(3);
  GateInputs in = inputs();
  for (int i = 0; i < 5'000; ++i) {
    if (i % 100 == 0) {
      in.requested_W_E.linear = 0.2 * Vector3d(random.normal(), random.normal(), random.normal());
      in.requested_W_E.angular = Vector3d(random.normal(), random.normal(), random.normal());
    }
    output = gate_.apply(in);
    linear.take(output.V_W_E.linear);
    angular.take(output.V_W_E.angular);
    if (i % 100 != 0) continue;
    EXPECT_STREQ(output.reason, "acceleration or jerk");
  }
  const GateLimits limits = smooth();
  EXPECT_LE(linear.jerk, limits.linear_jerk * (1 + 1e-6));
  EXPECT_LE(angular.jerk, limits.angular_jerk * (1 + 1e-6));
  EXPECT_LE(linear.acceleration, limits.linear_acceleration * kRounding);
  EXPECT_LE(angular.acceleration, limits.angular_acceleration * kRounding);
  EXPECT_LE(linear.speed, limits.linear_speed * kRounding);
  EXPECT_LE(angular.speed, limits.angular_speed * kRounding);
}

TEST_F(JerkLimitedGate, AHandThatCannotStopBeforeItsWallBrakesByTheStopProfile) {
  GateInputs in = inputs();
  in.requested_W_E = {{0.1, 0, 0}, {0, 0, 0}};
  for (int i = 0; i < 1000; ++i) gate_.apply(in);
  in.X_WE.translation().x() = 0.9999;  // displaced to 0.1 mm from the wall
  double& x = in.X_WE.translation().x();
  for (int i = 0; i < 100; ++i) x += kCycle * gate_.apply(in).V_W_E.linear.x();
  EXPECT_EQ(gate_.last().linear.x(), 0);
  EXPECT_LT(x, 1.005);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(gate_.apply(in).V_W_E.linear.x(), 0) << "beyond it";
  in.requested_W_E.linear.x() = -0.1;
  for (int i = 0; i < 1000; ++i) gate_.apply(in);
  EXPECT_NEAR(gate_.last().linear.x(), -0.1, 1e-12) << "back is free";
}

}  // namespace
}  // namespace palpate::control
