#include "core/math/random.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace palpate::math {
namespace {

TEST(Random, SeedsAndStreamsRepeatAndDiffer) {
  Random a(7), again(7), other(8), stream(7, "imu"), sibling(7, "wrench");
  bool differs_by_seed = false, differs_by_stream = false, differs_among_streams = false;
  for (int k = 0; k < 100; ++k) {
    const std::uint64_t x = a.next(), s = stream.next();
    EXPECT_EQ(x, again.next());
    differs_by_seed |= x != other.next();
    differs_by_stream |= x != s;
    differs_among_streams |= s != sibling.next();
  }
  EXPECT_TRUE(differs_by_seed && differs_by_stream && differs_among_streams);
}

TEST(Random, AStreamDoesNotDependOnWhatWasDrawn) {
  Random fresh(7), used(7);
  for (int k = 0; k < 13; ++k) used.normal();
  Random a = fresh.split("imu").split("noise"), b = used.split("imu").split("noise");
  for (int k = 0; k < 20; ++k) EXPECT_EQ(a.normal(), b.normal());
}

/// Expects mean and variance within 5 standard errors of their estimates.
void expect_moments(const std::vector<double>& x, double mean, double variance, double fourth) {
  double m = 0, v = 0;
  for (const double value : x) m += value;
  m /= x.size();
  for (const double value : x) v += (value - mean) * (value - mean);
  v /= x.size();
  EXPECT_NEAR(m, mean, 5 * std::sqrt(variance / x.size()));
  EXPECT_NEAR(v, variance, 5 * std::sqrt((fourth - variance * variance) / x.size()));
}

TEST(Random, UniformIsUniform) {
  Random random(11);
  std::vector<double> x(200000);
  for (double& value : x) {
    value = random.uniform(-1, 3);
    ASSERT_GE(value, -1);
    ASSERT_LT(value, 3);
  }
  expect_moments(x, 1, 16.0 / 12, 256.0 / 80);
}

TEST(Random, NormalIsNormal) {
  Random random(12);
  std::vector<double> x(200000);
  int beyond[4] = {};
  for (double& value : x) {
    value = random.normal();
    for (int k = 1; k <= 3; ++k) beyond[k] += std::abs(value) > k;
  }
  expect_moments(x, 0, 1, 3);
  for (int k = 1; k <= 3; ++k) {
    const double p = std::erfc(k / std::sqrt(2.0)), n = static_cast<double>(x.size());
    EXPECT_NEAR(beyond[k] / n, p, 5 * std::sqrt(p * (1 - p) / n)) << k << " sigma";
  }
}

TEST(Random, BelowIsEvenOverItsRange) {
  Random random(13);
  int counts[7] = {};
  const int n = 70000;
  for (int k = 0; k < n; ++k) ++counts[random.below(7)];
  for (const int count : counts) EXPECT_NEAR(count, n / 7.0, 5 * std::sqrt(n / 7.0));
  EXPECT_EQ(random.below(1), 0u);
}

// The published test vector of xoshiro256++ from the state {1, 2, 3, 4} cannot be set from outside,
// so the generator is implemented a second time here, directly from the paper.
TEST(Random, IsXoshiroSeededBySplitMix) {
  std::uint64_t seeder = 42, s[4];
  for (std::uint64_t& word : s) {
    std::uint64_t z = seeder += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    word = z ^ (z >> 31);
  }
  const auto rotl = [](std::uint64_t x, int k) { return (x << k) | (x >> (64 - k)); };
  Random random(42);
  for (int k = 0; k < 10; ++k) {
    EXPECT_EQ(random.next(), rotl(s[0] + s[3], 23) + s[0]);
    const std::uint64_t t = s[1] << 17;
    s[2] ^= s[0], s[3] ^= s[1], s[1] ^= s[2], s[0] ^= s[3];
    s[2] ^= t;
    s[3] = rotl(s[3], 45);
  }
}

}  // namespace
}  // namespace palpate::math
