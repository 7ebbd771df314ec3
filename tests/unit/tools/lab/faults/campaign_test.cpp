#include "tools/lab/faults/campaign.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <limits>
#include <set>

#include "tools/lab/faults/isolated.hpp"
#include "tools/lab/faults/rows.hpp"

namespace palpate::faults {
namespace {

TEST(Isolated, ResultsComeInOrderFromHoweverManyProcesses) {
  for (const int jobs : {1, 3, 8}) {
    int calls = 0;
    const std::vector<RunResult> results = run_isolated(
        5, jobs,
        [](int i) {
          RunResult result;
          result.measured = 10 * i;
          return result;
        },
        [&](int done) { EXPECT_EQ(done, ++calls); });
    ASSERT_EQ(results.size(), 5u);
    for (int i = 0; i < 5; ++i) EXPECT_EQ(results[i].measured, 10 * i);
    EXPECT_EQ(calls, 5);
  }
}

TEST(Isolated, ACrashOrAnExceptionIsOneResultAndTheRestGoesOn) {
  const std::vector<RunResult> results = run_isolated(7, 2, [](int i) {
    if (i == 2) std::raise(SIGKILL);
    if (i == 5) std::_Exit(3);
    if (i == 4) throw std::runtime_error("out of order");
    return RunResult();
  });
  for (int i = 0; i < 7; ++i) {
    EXPECT_EQ(results[i].crashed, i == 2 || i == 5) << i;
    EXPECT_EQ(results[i].outcome == Outcome::kFailed, i == 2 || i == 5 || i == 4) << i;
  }
  EXPECT_NE(std::string(results[4].miss.data()).find("out of order"), std::string::npos);
}

// Brown, Cai, DasGupta 2001, "Interval estimation for a binomial proportion", equation 4.
TEST(Wilson, BoundOfOneThousandOfOneThousand) {
  EXPECT_NEAR(wilson_lower(1000, 1000), 1 / (1 + 1.959964 * 1.959964 / 1000), 1e-9);
  EXPECT_GT(wilson_lower(1000, 1000), 0.996);
  EXPECT_NEAR(wilson_lower(5, 10), 0.2366, 1e-4);
  EXPECT_NEAR(wilson_lower(0, 10), 0, 1e-12);
}

TEST(RowReport, OneSeedBelowTheFigureIsAMissWithItsNumber) {
  Row row{"5", "stops", "", "ms", 21, false, {}};
  std::vector<RunResult> results(3);
  for (std::size_t i = 0; i < 3; ++i) results[i].seed = 1 + i, results[i].measured = 10;
  EXPECT_TRUE(summarise(row, results).met());
  results[1].measured = 22;
  const RowReport report = summarise(row, results);
  EXPECT_FALSE(report.met());
  EXPECT_EQ(report.survived(), 3);
  EXPECT_EQ(report.measured, 22);
  EXPECT_EQ(report.below_figure, 1);
  EXPECT_NE(report.miss.find("seed 2"), std::string::npos);
  row.mean = true;
  EXPECT_TRUE(summarise(row, results).met());
  results[2].fail("fell over");
  EXPECT_FALSE(summarise(row, results).met());
  EXPECT_EQ(summarise(row, results).worst(), Outcome::kFailed);
}

TEST(Rows, EveryRowOfTheTableIsHereOrNamedElsewhere) {
  std::set<std::string> numbers;
  for (const Row& row : all_rows()) {
    numbers.insert(row.number);
    EXPECT_TRUE(row.run) << row.fault;
  }
  for (const Elsewhere& row : rows_elsewhere())
    EXPECT_TRUE(numbers.insert(row.number).second) << row.number << " is in both";
  for (int i = 1; i <= 26; ++i) EXPECT_EQ(numbers.count(std::to_string(i)), 1u) << i;
  EXPECT_EQ(choose_rows({"12"}).size(), 6u);
  EXPECT_THROW(choose_rows({"8"}), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::faults
