#include "tools/lab/uncertainty/latin_hypercube.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <stdexcept>
#include <vector>

namespace palpate::uncertainty {
namespace {

std::vector<double> all_of(const LatinHypercube& sample, const std::string& parameter) {
  std::vector<double> values;
  for (int i = 0; i < sample.count(); ++i) values.push_back(sample.at(parameter, i));
  return values;
}

TEST(LatinHypercube, HasOneDrawInEveryStratum) {
  for (const int count : {1, 2, 17, 100}) {
    std::set<int> strata;
    for (const double value : all_of({3, count}, "hand x")) {
      EXPECT_GE(value, 0);
      EXPECT_LT(value, 1);
      strata.insert(static_cast<int>(value * count));
    }
    EXPECT_EQ(strata.size(), static_cast<std::size_t>(count));
  }
}

TEST(LatinHypercube, ParametersAreUncorrelated) {
  const LatinHypercube sample(5, 400);
  const std::vector<double> a = all_of(sample, "hand x"), b = all_of(sample, "hand y");
  double product = 0;
  for (std::size_t i = 0; i < a.size(); ++i) product += (a[i] - 0.5) * (b[i] - 0.5);
  // Twelve times the mean product is the correlation, of deviation 1 / sqrt(400).
  EXPECT_LT(std::abs(12 * product / 400), 0.2);
}

TEST(LatinHypercube, DependsOnSeedCountAndNameAlone) {
  const LatinHypercube sample(1, 100);
  EXPECT_EQ(all_of(sample, "log E"), all_of({1, 100}, "log E"));
  EXPECT_NE(all_of(sample, "log E"), all_of({2, 100}, "log E"));
  EXPECT_NE(all_of(sample, "log E"), all_of(sample, "density"));
  // Recorded once: the same on every machine.
  EXPECT_EQ(sample.at("log E", 0), 0.26738297145227785);
  EXPECT_EQ(sample.at("log E", 99), 0.53711768684309802);
}

TEST(LatinHypercube, RefusesDrawsThatDoNotExist) {
  EXPECT_THROW(LatinHypercube(1, 0), std::invalid_argument);
  const LatinHypercube sample(1, 10);
  EXPECT_THROW(sample.at("log E", -1), std::out_of_range);
  EXPECT_THROW(sample.at("log E", 10), std::out_of_range);
}

TEST(TruncatedNormal, InvertsTheDistribution) {
  const auto cumulative = [](double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); };
  for (const auto& [lower, upper] : {std::pair{-2.0, 2.0}, {-3.0, 3.0}, {-1.0, 0.5}, {0.0, 2.0}}) {
    EXPECT_NEAR(truncated_normal(0, lower, upper), lower, 1e-12);
    for (double share = 0.01; share < 1; share += 0.07) {
      const double x = truncated_normal(share, lower, upper);
      const double expected = cumulative(lower) + share * (cumulative(upper) - cumulative(lower));
      EXPECT_NEAR(cumulative(x), expected, 1e-12) << share;
    }
  }
}

TEST(TruncatedNormal, HasTheMomentsOfANormalDistributionWithoutItsTails) {
  const LatinHypercube sample(7, 2000);
  double sum = 0, squares = 0, halves = 0;
  for (const double share : all_of(sample, "hand x")) {
    const double z = truncated_normal(share, -2, 2), half = half_normal(share, 2);
    EXPECT_LE(std::abs(z), 2);
    EXPECT_GE(half, 0);
    EXPECT_LE(half, 2);
    sum += z;
    squares += z * z;
    halves += half;
  }
  // phi(2) = 0.05399, Phi(2) - Phi(-2) = 0.95450: variance 1 - 4 phi(2) / 0.9545 = 0.77374; the
  // mean of the half is 2 (phi(0) - phi(2)) / 0.9545 = 0.72279.
  EXPECT_NEAR(sum / 2000, 0, 1e-3);
  EXPECT_NEAR(squares / 2000, 0.77374, 2e-3);
  EXPECT_NEAR(halves / 2000, 0.72279, 1e-3);
}

}  // namespace
}  // namespace palpate::uncertainty
