#include "core/control/discrepancy_policy.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <utility>

#include "core/control/safety_gate.hpp"

namespace palpate::control {
namespace {

DiscrepancyPolicy policy_of(DiscrepancyAction action, double speed = 0.25) {
  return DiscrepancyPolicy({action, speed});
}

double factor_after(DiscrepancyPolicy& policy, bool in_doubt, int cycles) {
  for (int i = 0; i < cycles; ++i) policy.update(in_doubt, 1e-3);
  return policy.factor();
}

TEST(DiscrepancyPolicy, ReachesItsFactorExactlyAndReturns) {
  for (const auto& [action, goal] :
       {std::pair{DiscrepancyAction::kContinue, 1.0}, std::pair{DiscrepancyAction::kSlow, 0.3},
        std::pair{DiscrepancyAction::kStop, 0.0}}) {
    DiscrepancyPolicy policy = policy_of(action, 0.3);
    EXPECT_EQ(factor_after(policy, false, 1000), 1);
    EXPECT_EQ(factor_after(policy, true, 251), goal);
    EXPECT_EQ(factor_after(policy, true, 1000), goal);
    EXPECT_EQ(factor_after(policy, false, 251), 1);
  }
}

// The gate need not limit the change of a constant command within its default speeds.
TEST(DiscrepancyPolicy, KeepsTheGatesDefaultAccelerations) {
  const GateLimits limits;
  DiscrepancyPolicy policy = policy_of(DiscrepancyAction::kStop);
  double before = 1;
  for (int i = 0; i < 600; ++i) {
    policy.update(i < 300, 1e-3);
    const double rate = std::abs(policy.factor() - before) / 1e-3;
    EXPECT_LE(rate * limits.linear_speed, limits.linear_acceleration);
    EXPECT_LE(rate * limits.angular_speed, limits.angular_acceleration * (1 + 1e-9));
    before = policy.factor();
  }
  EXPECT_EQ(before, 1);
}

TEST(DiscrepancyPolicy, ReplacementContinuesAndResetDoesNot) {
  DiscrepancyPolicy slow = policy_of(DiscrepancyAction::kSlow), stop;
  factor_after(slow, true, 500);
  stop = policy_of(DiscrepancyAction::kStop);
  stop.take_over(slow);
  EXPECT_NEAR(factor_after(stop, true, 1), 0.25 - 0.004, 1e-12);
  stop.reset();
  EXPECT_EQ(stop.factor(), 1);
}

TEST(DiscrepancyPolicy, IgnoresTimeStepsThatAreNone) {
  DiscrepancyPolicy policy = policy_of(DiscrepancyAction::kStop);
  for (const double dt : {0.0, -1.0, std::nan(""), HUGE_VAL}) policy.update(true, dt);
  EXPECT_EQ(policy.factor(), 1);
  policy.update(true, 10);
  EXPECT_EQ(policy.factor(), 0);
}

TEST(DiscrepancyPolicy, RefusesASpeedOutOfRange) {
  for (const double speed : {-0.1, 1.1, std::nan("")})
    EXPECT_THROW(policy_of(DiscrepancyAction::kSlow, speed), std::invalid_argument) << speed;
}

}  // namespace
}  // namespace palpate::control
