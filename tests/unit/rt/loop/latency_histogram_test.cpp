#include "rt/loop/latency_histogram.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace palpate::loop {
namespace {

TEST(LatencyHistogram, IsEmptyAtFirst) {
  const LatencyHistogram histogram;
  EXPECT_EQ(histogram.count(), 0);
  EXPECT_EQ(histogram.max_ns(), 0);
  EXPECT_EQ(histogram.quantile_ns(0.99), 0);
}

TEST(LatencyHistogram, QuantilesAreWithinOneBucketOfSortedSamples) {
  std::mt19937 random(1);
  std::lognormal_distribution<double> duration(std::log(50e3), 2.5);
  LatencyHistogram histogram;
  std::vector<std::int64_t> samples;
  for (int i = 0; i < 20000; ++i) {
    samples.push_back(static_cast<std::int64_t>(duration(random)));
    histogram.record(samples.back());
  }
  std::sort(samples.begin(), samples.end());
  for (const double fraction : {0.01, 0.5, 0.9, 0.99, 0.999}) {
    const auto rank = static_cast<std::size_t>(std::ceil(fraction * samples.size())) - 1;
    const double exact = static_cast<double>(samples[rank]);
    EXPECT_GE(histogram.quantile_ns(fraction), samples[rank]) << fraction;
    EXPECT_LE(static_cast<double>(histogram.quantile_ns(fraction)), exact * (1 + 1.0 / 32) + 2)
        << fraction;
  }
  EXPECT_EQ(histogram.quantile_ns(1), samples.back());
  EXPECT_EQ(histogram.max_ns(), samples.back());
  EXPECT_EQ(histogram.count(), 20000);
}

TEST(LatencyHistogram, ABoundIsNeverBelowTheSampleNorMuchAboveIt) {
  for (std::int64_t sample = 0; sample < std::int64_t{1} << 36; sample += sample / 7 + 1) {
    LatencyHistogram histogram;
    histogram.record(sample);
    histogram.record(std::int64_t{1} << 40);  // excludes max
    const std::int64_t bound = histogram.quantile_ns(0.5);
    ASSERT_GE(bound, sample);
    ASSERT_LE(bound - sample, std::max<std::int64_t>(2, sample / 32)) << sample;
  }
}

TEST(LatencyHistogram, TakesWhatIsOutOfRange) {
  LatencyHistogram histogram;
  histogram.record(-5);
  EXPECT_EQ(histogram.max_ns(), 0);
  EXPECT_LE(histogram.quantile_ns(1), 1);
  const std::int64_t hour = 3600'000'000'000;
  histogram.record(hour);
  EXPECT_EQ(histogram.quantile_ns(1), hour);
}

TEST(LatencyHistogram, CountsWhatLiesAbove) {
  LatencyHistogram histogram;
  for (int i = 1; i <= 100; ++i) histogram.record(i * 20'000);
  EXPECT_EQ(histogram.count_above(2'000'000), 0);
  EXPECT_EQ(histogram.count_above(0), 100);
  // Within the width of a bucket, 3 %.
  EXPECT_NEAR(static_cast<double>(histogram.count_above(1'000'000)), 50, 2);
}

TEST(LatencyHistogram, MergingEqualsRecordingAll) {
  LatencyHistogram all;
  LatencyHistogram even;
  LatencyHistogram odd;
  for (int i = 0; i < 1000; ++i) {
    all.record(i * i * 37);
    (i % 2 == 0 ? even : odd).record(i * i * 37);
  }
  even.merge(odd);
  EXPECT_EQ(even.count(), all.count());
  EXPECT_EQ(even.max_ns(), all.max_ns());
  for (const double fraction : {0.1, 0.5, 0.77, 0.99})
    EXPECT_EQ(even.quantile_ns(fraction), all.quantile_ns(fraction));
  even.clear();
  EXPECT_EQ(even.count(), 0);
  EXPECT_EQ(even.quantile_ns(0.5), 0);
}

}  // namespace
}  // namespace palpate::loop
