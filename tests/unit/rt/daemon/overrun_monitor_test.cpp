#include "rt/daemon/health.hpp"

#include <gtest/gtest.h>

namespace palpate::daemon {
namespace {

constexpr double kPeriod = 1e-3;
constexpr std::int64_t kOverrunMillisecond = 1'000'000;
using Verdict = OverrunMonitor::Verdict;

TEST(OverrunMonitor, PunctualLoopIsFine) {
  OverrunMonitor monitor{OverrunPolicy()};
  for (int i = 1; i <= 1000; ++i) {
    EXPECT_EQ(monitor.record(i * kOverrunMillisecond, 50'000, kPeriod), Verdict::kFine);
  }
}

TEST(OverrunMonitor, SixMillisecondsOfLatenessWithinTwentyDegrade) {
  OverrunMonitor monitor{OverrunPolicy()};
  std::int64_t now = kOverrunMillisecond;
  monitor.record(now, 0, kPeriod);
  now += 4 * kOverrunMillisecond;
  EXPECT_EQ(monitor.record(now, 3 * kOverrunMillisecond, kPeriod), Verdict::kFine);
  now += 4 * kOverrunMillisecond;
  EXPECT_EQ(monitor.record(now, 3 * kOverrunMillisecond, kPeriod), Verdict::kDegraded);
  // ... and recover once the window has passed.
  Verdict verdict = Verdict::kDegraded;
  for (int i = 0; i < 25; ++i) verdict = monitor.record(now += kOverrunMillisecond, 0, kPeriod);
  EXPECT_EQ(verdict, Verdict::kFine);
}

TEST(OverrunMonitor, OneLateWakeUpOfSixMillisecondsIsEnough) {
  OverrunMonitor monitor{OverrunPolicy()};
  monitor.record(kOverrunMillisecond, 0, kPeriod);
  EXPECT_EQ(monitor.record(8 * kOverrunMillisecond, 6 * kOverrunMillisecond, kPeriod),
            Verdict::kDegraded);
}

TEST(OverrunMonitor, TwentyMillisecondsWithoutCommandStop) {
  OverrunMonitor monitor{OverrunPolicy()};
  monitor.record(kOverrunMillisecond, 0, kPeriod);
  EXPECT_EQ(monitor.record(21 * kOverrunMillisecond, 19 * kOverrunMillisecond, kPeriod),
            Verdict::kDegraded);
  EXPECT_EQ(monitor.record(42 * kOverrunMillisecond, 20 * kOverrunMillisecond, kPeriod),
            Verdict::kSafeStop);
}

}  // namespace
}  // namespace palpate::daemon
