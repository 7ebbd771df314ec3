#include "tools/common/bootstrap.hpp"

#include <gtest/gtest.h>

#include "core/math/random.hpp"

namespace palpate::common {
namespace {

TEST(Bootstrap, MedianOfFewValues) {
  EXPECT_EQ(median_of({3}).value, 3);
  EXPECT_EQ(median_of({4, 1}).value, 2.5);
  EXPECT_EQ(median_of({6, 1, 2}).value, 2);
  EXPECT_EQ(median_and_interval({}, 1), "not available");
  EXPECT_EQ(median_and_interval({1.25}, 2), "1.25");
  EXPECT_EQ(median_and_interval({1, 2, 6}, 1), "2.0 (1.0 to 6.0)");
}

TEST(Bootstrap, IntervalHoldsTheTrueMedianAboutAsOftenAsItSays) {
  math::Random random(5);
  int held = 0;
  constexpr int kRounds = 400, kValues = 25;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<double> values(kValues);
    for (double& value : values) value = 7 + 2 * random.normal();
    const Interval95 interval = median_of(values);
    held += interval.low <= 7 && 7 <= interval.high ? 1 : 0;
  }
  EXPECT_GT(held, 0.90 * kRounds);
  EXPECT_LT(held, 0.99 * kRounds);
}

TEST(Bootstrap, NeverTheSameTwiceWouldBeNoFigure) {
  const std::vector<double> values{5, 1, 4, 2, 8, 9, 3};
  EXPECT_EQ(median_of(values).low, median_of(values).low);
  EXPECT_EQ(median_of(values).high, median_of(values).high);
}

TEST(Share, IntervalIsWilsons) {
  // Newcombe (1998), table I: 81 of 263 gives 0.2553 to 0.3662; 0 of 20: 0 to 0.1611.
  const Interval95 share = share_of(81, 263);
  EXPECT_NEAR(share.low, 0.2553, 1e-4);
  EXPECT_NEAR(share.high, 0.3662, 1e-4);
  EXPECT_NEAR(share_of(0, 20).low, 0, 1e-12);
  EXPECT_NEAR(share_of(0, 20).high, 0.1611, 1e-4);
  EXPECT_EQ(share_and_interval(0, 0), "not available");
  EXPECT_EQ(share_and_interval(20, 20), "100 % (84 to 100)");
}

}  // namespace
}  // namespace palpate::common
