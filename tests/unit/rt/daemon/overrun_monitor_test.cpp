#include "rt/daemon/health.hpp"

#include <gtest/gtest.h>

namespace palpate::daemon {
namespace {

constexpr double kPeriod = 1e-3;
constexpr std::int64_t kMillisecond = 1'000'000;
using Verdict = OverrunMonitor::Verdict;

TEST(OverrunMonitor, PunctualLoopIsFine) {
  OverrunMonitor monitor{OverrunPolicy()};
  for (int i = 1; i <= 1000; ++i) {
    EXPECT_EQ(monitor.record(i * kMillisecond, 50'000, kPeriod), Verdict::kFine);
  }
}

TEST(OverrunMonitor, SixMillisecondsOfLatenessWithinTwentyDegrade) {
  OverrunMonitor monitor{OverrunPolicy()};
  std::int64_t now = kMillisecond;
  monitor.record(now, 0, kPeriod);
  now += 4 * kMillisecond;
  EXPECT_EQ(monitor.record(now, 3 * kMillisecond, kPeriod), Verdict::kFine);
  now += 4 * kMillisecond;
  EXPECT_EQ(monitor.record(now, 3 * kMillisecond, kPeriod), Verdict::kDegraded);
  // ... and recover once the window has passed.
  Verdict verdict = Verdict::kDegraded;
  for (int i = 0; i < 25; ++i) verdict = monitor.record(now += kMillisecond, 0, kPeriod);
  EXPECT_EQ(verdict, Verdict::kFine);
}

TEST(OverrunMonitor, OneLateWakeUpOfSixMillisecondsIsEnough) {
  OverrunMonitor monitor{OverrunPolicy()};
  monitor.record(kMillisecond, 0, kPeriod);
  EXPECT_EQ(monitor.record(8 * kMillisecond, 6 * kMillisecond, kPeriod), Verdict::kDegraded);
}

TEST(OverrunMonitor, TwentyMillisecondsWithoutCommandStop) {
  OverrunMonitor monitor{OverrunPolicy()};
  monitor.record(kMillisecond, 0, kPeriod);
  EXPECT_EQ(monitor.record(21 * kMillisecond, 19 * kMillisecond, kPeriod), Verdict::kDegraded);
  EXPECT_EQ(monitor.record(42 * kMillisecond, 20 * kMillisecond, kPeriod), Verdict::kSafeStop);
}

}  // namespace
}  // namespace palpate::daemon
