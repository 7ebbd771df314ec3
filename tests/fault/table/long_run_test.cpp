#include "tools/lab/faults/long_run.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace palpate::faults {
namespace {

TEST(LongRun, GetsOverWhateverComes) {
  LongRun run(7);
  run.run(150);
  const LongRunReport& report = run.report();
  for (const std::string& complaint : report.complaints) ADD_FAILURE() << complaint;
  EXPECT_EQ(report.failures, 0);
  const int faults = std::accumulate(report.faults.begin(), report.faults.end(), 0,
                                     [](int sum, const auto& each) { return sum + each.second; });
  EXPECT_GE(faults, 20);
  EXPECT_GE(report.faults.size(), 10u);
  EXPECT_GE(report.stops, 1);
  EXPECT_GT(report.messages, 100'000);
  for (const double error : report.errors) EXPECT_LT(error, 0.01);
}

TEST(LongRun, IsTheSameTwice) {
  LongRun first(3), second(3);
  first.run(20);
  second.run(12);
  second.run(8);
  EXPECT_EQ(first.report().errors, second.report().errors);
  EXPECT_EQ(first.report().faults, second.report().faults);
}

}  // namespace
}  // namespace palpate::faults
