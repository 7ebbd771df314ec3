#include "rt/loop/fixed_rate_loop.hpp"

#include <gtest/gtest.h>

#include <random>

namespace palpate::loop {
namespace {

constexpr std::int64_t kPeriod = 1'000'000;
constexpr std::int64_t kStart = 7'123'456'789;

TEST(TimeGrid, KeepsThePhaseWhateverTheCyclesTake) {
  TimeGrid grid(kPeriod);
  std::int64_t now = kStart;
  for (int cycle = 1; cycle <= 1000; ++cycle) {
    const std::int64_t wake_up = grid.begin_wait(now);
    ASSERT_EQ(wake_up, kStart + cycle * kPeriod);
    const Tick tick = grid.end_wait(wake_up + 40'000);
    ASSERT_EQ(tick.lateness_ns, 40'000);
    ASSERT_EQ(tick.missed, 0);
    now = tick.now_ns + (cycle * 7919) % 900'000;
  }
  EXPECT_EQ(grid.overruns(), 0);
  EXPECT_EQ(grid.overrun_ns(), 0);
}

TEST(TimeGrid, ALongCycleIsOneOverrunAndSkipsWhatItCovers) {
  TimeGrid grid(kPeriod);
  const Tick first = grid.end_wait(grid.begin_wait(kStart));
  // Two and a half periods of work: the points 1 and 2 periods later have passed.
  const std::int64_t wake_up = grid.begin_wait(first.now_ns + 5 * kPeriod / 2);
  EXPECT_EQ(wake_up, first.now_ns + 3 * kPeriod);
  EXPECT_EQ(grid.end_wait(wake_up).missed, 2);
  EXPECT_EQ(grid.overruns(), 1);
  EXPECT_EQ(grid.overrun_ns(), 3 * kPeriod / 2);  // past its end one period after its start
}

TEST(TimeGrid, ALateWakeUpIsOneOverrunAndSkipsWhatItSleptThrough) {
  TimeGrid grid(kPeriod);
  const std::int64_t wake_up = grid.begin_wait(kStart);
  const Tick late = grid.end_wait(wake_up + 7 * kPeriod / 2);
  EXPECT_EQ(late.lateness_ns, 7 * kPeriod / 2);
  EXPECT_EQ(late.missed, 3);
  EXPECT_EQ(grid.overruns(), 1);
  EXPECT_EQ(grid.overrun_ns(), 7 * kPeriod / 2);
  // The following short cycle ends in time: no second overrun, back on the grid.
  EXPECT_EQ(grid.begin_wait(late.now_ns + kPeriod / 4), wake_up + 4 * kPeriod);
  EXPECT_EQ(grid.overruns(), 1);
}

TEST(TimeGrid, LatenessBelowAPeriodIsNoOverrunUnlessTheCycleEndsPastItsEnd) {
  TimeGrid grid(kPeriod);
  const std::int64_t wake_up = grid.begin_wait(kStart);
  const Tick tick = grid.end_wait(wake_up + 9 * kPeriod / 10);
  EXPECT_EQ(grid.overruns(), 0);
  EXPECT_EQ(grid.begin_wait(tick.now_ns + 3 * kPeriod / 10), wake_up + 2 * kPeriod);
  EXPECT_EQ(grid.overruns(), 1);
  EXPECT_EQ(grid.overrun_ns(), 2 * kPeriod / 10);
}

TEST(TimeGrid, TicksAndMissedPointsAddUpToTheTimeThatWentBy) {
  std::mt19937 random(4);
  std::exponential_distribution<double> work(1 / 0.7e6);
  std::exponential_distribution<double> late(1 / 0.2e6);
  TimeGrid grid(kPeriod);
  std::int64_t now = kStart;
  std::int64_t points = 0;
  std::int64_t last_point = 0;
  for (int cycle = 0; cycle < 10000; ++cycle) {
    const std::int64_t wake_up = grid.begin_wait(now);
    ASSERT_GE(wake_up, now);
    ASSERT_EQ((wake_up - kStart) % kPeriod, 0);
    const Tick tick = grid.end_wait(wake_up + static_cast<std::int64_t>(late(random)));
    points += 1 + tick.missed;
    last_point = tick.now_ns - tick.lateness_ns % kPeriod;
    now = tick.now_ns + static_cast<std::int64_t>(work(random));
  }
  EXPECT_GT(grid.overruns(), 1000);
  EXPECT_EQ(kStart + points * kPeriod, last_point);
}

TEST(TimeGrid, StartsFromZeroAfterARestart) {
  TimeGrid grid(kPeriod);
  grid.end_wait(grid.begin_wait(kStart));
  grid.restart();
  EXPECT_EQ(grid.begin_wait(kStart + 100 * kPeriod), kStart + 101 * kPeriod);
  EXPECT_EQ(grid.overruns(), 0);
}

TEST(TimeGrid, RefusesAPeriodThatIsNotPositive) {
  EXPECT_THROW(TimeGrid(0), std::invalid_argument);
  EXPECT_THROW(TimeGrid(-1), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::loop
