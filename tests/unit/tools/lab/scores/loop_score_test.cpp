#include "tools/lab/scores/loop_score.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate::scores {
namespace {

constexpr double kPeriod = 1e-3;

twist_command_t command(int seq, double vx, double wz = 0) {
  twist_command_t message = {};
  message.seq = seq;
  message.valid = 1;
  message.twist[0] = vx;
  message.twist[5] = wz;
  return message;
}

log::RunLog commands(std::vector<twist_command_t> messages) {
  log::RunLog run;
  run.commands = std::move(messages);
  return run;
}

control::GateLimits limits() {
  control::GateLimits limits;
  limits.linear_speed = 0.1;
  limits.angular_speed = 0.5;
  limits.linear_acceleration = 0.5;
  limits.angular_acceleration = 2;
  return limits;
}

TEST(CommandScore, CommandsAtTheLimitsPass) {
  const CommandScore score =
      check_commands(commands({command(0, 0), command(1, 0.0005, 0.002), command(2, 0.001, 0.004)}),
                     limits(), kPeriod);
  EXPECT_EQ(score.violations, 0);
  EXPECT_NEAR(score.linear_acceleration, 0.5, 1e-9);
  EXPECT_NEAR(score.angular_acceleration, 2, 1e-9);
}

TEST(CommandScore, SpeedAccelerationAndNumbersThatAreNoneAreFound) {
  EXPECT_EQ(check_commands(commands({command(0, 0.1001)}), limits(), kPeriod).violations, 1);
  EXPECT_EQ(check_commands(commands({command(0, 0, 0.51)}), limits(), kPeriod).violations, 1);
  EXPECT_EQ(
      check_commands(commands({command(0, 0), command(1, 0.0006)}), limits(), kPeriod).violations,
      1);
  EXPECT_EQ(check_commands(commands({command(0, std::nan(""))}), limits(), kPeriod).violations, 1);
}

TEST(CommandScore, LostMessagesAndStopsAreNoViolation) {
  EXPECT_EQ(
      check_commands(commands({command(0, 0), command(2, 0.0009)}), limits(), kPeriod).violations,
      0);
  EXPECT_EQ(
      check_commands(commands({command(0, 0.09), command(1, 0)}), limits(), kPeriod).violations, 0);
}

TEST(CommandScore, AStoppedDaemonMayBrakeOnly) {
  std::vector<twist_command_t> braking{command(0, 0.05), command(1, 0.04)};
  braking[1].valid = 0;
  EXPECT_EQ(check_commands(commands(braking), limits(), kPeriod).violations, 0);
  braking[1] = command(1, 0.0501);
  braking[1].valid = 0;
  EXPECT_EQ(check_commands(commands(braking), limits(), kPeriod).violations, 1);
}

TEST(LoopScore, LastHealthCountsAndAFaultOnTheWayIsKept) {
  log::RunLog run;
  for (const int state : {1, 2, 4, 2}) {
    health_t health = {};
    health.state = state;
    health.cycles = static_cast<std::int64_t>(run.health.size()) * 100;
    health.phase_count = 10;
    health.p99_us[0] = 250;
    run.health.push_back(health);
  }
  const LoopScore score = score_loop(run);
  EXPECT_EQ(score.cycles, 300);
  EXPECT_EQ(score.p99_us, 250);
  EXPECT_TRUE(score.faulted);
  EXPECT_THROW(score_loop(log::RunLog()), std::runtime_error);
}

}  // namespace
}  // namespace palpate::scores
