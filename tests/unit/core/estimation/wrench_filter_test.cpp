#include "core/estimation/wrench_filter.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <random>

#include "rt/loop/allocation_counter.hpp"

namespace palpate::estimation {
namespace {

WrenchFilter::Vector drawn(const WrenchFilter::Covariance& P, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  WrenchFilter::Vector z(P.rows());
  for (double& value : z) value = normal(random);
  return P.diagonal().cwiseSqrt().cwiseProduct(z);  // a prior is diagonal
}

/// Two hundred worlds that the filter's own assumptions make: what it says of its errors is true.
TEST(WrenchFilter, IsConsistentWithAWorldOfItsOwn) {
  constexpr int kSeeds = 200, kSteps = 50;
  const WrenchFilter::Options options;
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  double nees = 0, nis = 0, log_young_covered = 0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    WrenchFilter filter(1, options);
    const int states = filter.contact();
    WrenchFilter::Vector truth = drawn(filter.covariance(), random);
    for (int step = 0; step < kSteps; ++step) {
      const double kept = std::exp(-0.01 / options.memory);
      filter.predict(0.01);
      truth = kept * truth +
              std::sqrt(1 - kept * kept) * drawn(WrenchFilter(1, options).covariance(), random);
      WrenchFilter::Rows H = WrenchFilter::Rows::Zero(6, filter.size());
      for (int i = 0; i < 6; ++i)
        for (int j = 0; j < states; ++j) H(i, j) = normal(random) * (j < 6 ? 100 : 1);
      const WrenchFilter::Noise R = WrenchFilter::Noise::Identity(6, 6) * 0.05 * 0.05;
      WrenchFilter::Wrenches y = H * (truth - filter.mean());
      for (double& value : y) value += 0.05 * normal(random);
      const double test = filter.test(H, y, R);
      ASSERT_GT(test, 0);
      nis += test;
      filter.correct();
    }
    const Eigen::VectorXd error = (truth - filter.mean()).head(states);
    const Eigen::MatrixXd P = filter.covariance().topLeftCorner(states, states);
    nees += error.dot(P.ldlt().solve(error));
    const int e = filter.log_young();
    log_young_covered += std::abs(error[e]) < 1.96 * filter.deviation(e) ? 1 : 0;
  }
  // 95 % bands of chi-squared means: of 200 * 13 and of 200 * 50 * 6 degrees of freedom.
  EXPECT_NEAR(nees / kSeeds / 13, 1, 1.96 * std::sqrt(2.0 / (kSeeds * 13)));
  EXPECT_NEAR(nis / kSeeds / kSteps / 6, 1, 1.96 * std::sqrt(2.0 / (kSeeds * kSteps * 6)));
  EXPECT_GT(log_young_covered / kSeeds, 0.9);
}

/// The same where the shape is seen, and virtual loads wander.
TEST(WrenchFilter, IsConsistentWhileTheShapeIsSeen) {
  constexpr int kSeeds = 200, kSteps = 50, kPoints = 5;
  constexpr double kNoise = 0.02, kStep = 0.03;
  const WrenchFilter::Options options;
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  double nees = 0;
  int states = 0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    WrenchFilter filter(1, options);
    filter.begin_loads(math::Vector6d::Constant(0.2));
    states = filter.contact();
    const WrenchFilter::Covariance prior = filter.covariance();
    WrenchFilter::Vector truth = drawn(prior, random);
    for (int step = 0; step < kSteps; ++step) {
      const double kept = std::exp(-kStep / options.memory);
      filter.predict(kStep);
      truth = kept * truth + std::sqrt(1 - kept * kept) * drawn(prior, random);
      truth.segment<6>(filter.load()) += std::sqrt(2 * kStep / options.load_memory) *
                                         drawn(prior, random).segment<6>(filter.load());
      const int n = filter.shape_size();
      WrenchFilter::ShapeMatrix matrix = WrenchFilter::ShapeMatrix::Zero(n, n);
      WrenchFilter::ShapeState vector = WrenchFilter::ShapeState::Zero(n);
      for (int point = 0; point < kPoints; ++point) {
        WrenchFilter::ShapeState h(n);
        for (int j = 0; j < n; ++j) h[j] = normal(random) * (j < 6 ? 100 : 1);
        const double z = h.dot(truth.head(n)) + kNoise * normal(random);
        matrix += h * h.transpose() / (kNoise * kNoise);
        vector += h * z / (kNoise * kNoise);
      }
      ASSERT_TRUE(filter.take(matrix, vector));
    }
    const Eigen::VectorXd error = (truth - filter.mean()).head(states);
    const Eigen::MatrixXd P = filter.covariance().topLeftCorner(states, states);
    nees += error.dot(P.ldlt().solve(error));
    EXPECT_LT(filter.deviation(filter.load()), 0.1);
  }
  EXPECT_NEAR(nees / kSeeds / states, 1, 1.96 * std::sqrt(2.0 / (kSeeds * states)));
}

TEST(WrenchFilter, WhatIsSeenIsRefusedWhereItIsNotFinite) {
  WrenchFilter filter(2, {});
  const int n = filter.shape_size();
  WrenchFilter::ShapeMatrix matrix = WrenchFilter::ShapeMatrix::Identity(n, n);
  WrenchFilter::ShapeState vector = WrenchFilter::ShapeState::Ones(n);
  EXPECT_FALSE(filter.take(matrix, vector.head(n - 1)));
  vector[3] = std::nan("");
  EXPECT_FALSE(filter.take(matrix, vector));
  vector[3] = 0;
  matrix(2, 2) = HUGE_VAL;
  EXPECT_FALSE(filter.take(matrix, vector));
  EXPECT_TRUE(filter.mean().isZero(0));
  matrix(2, 2) = 1;
  EXPECT_TRUE(filter.take(matrix, vector));
  EXPECT_EQ(filter.mean()[filter.load()], 0) << "nobody has begun with virtual loads";
  EXPECT_GT(filter.mean()[filter.log_young()], 0);
}

TEST(WrenchFilter, WhatTheWrenchesDoNotTellOfStaysUnobserved) {
  WrenchFilter filter(2, {});
  WrenchFilter::Rows H = WrenchFilter::Rows::Zero(12, filter.size());
  H.block<12, 12>(0, filter.bias(0)).setIdentity();
  const WrenchFilter::Noise R = WrenchFilter::Noise::Identity(12, 12) * 1e-6;
  for (int i = 0; i < 100; ++i) {
    filter.predict(0.01);
    filter.test(H, WrenchFilter::Wrenches::Constant(12, 0.01), R);
    filter.correct();
  }
  EXPECT_TRUE(filter.is_observed(filter.bias(0)));
  EXPECT_TRUE(filter.is_observed(filter.bias(1) + 5));
  EXPECT_FALSE(filter.is_observed(filter.log_young()));
  EXPECT_FALSE(filter.is_observed(filter.offset(1)));
  EXPECT_NEAR(filter.deviation(filter.log_young()), 0.5, 1e-9);
}

TEST(WrenchFilter, AContactComesAndGoesWithoutATrace) {
  WrenchFilter filter(1, {});
  const WrenchFilter::Covariance prior = filter.covariance();
  WrenchFilter::Rows H = WrenchFilter::Rows::Zero(6, filter.size());
  H.rightCols<3>().topRows<3>().setIdentity();
  const WrenchFilter::Noise R = WrenchFilter::Noise::Identity(6, 6) * 1e-4;
  EXPECT_FALSE(filter.is_observed(filter.contact()));
  filter.begin_contact({0.1, 0, 0}, 25 * Eigen::Matrix3d::Identity());
  WrenchFilter::Wrenches y = WrenchFilter::Wrenches::Zero(6);
  y.head<3>() = Eigen::Vector3d(0.9, 2, 3);
  ASSERT_GE(filter.test(H, y, R), 0);
  filter.correct();
  EXPECT_LT((filter.mean().tail<3>() - Eigen::Vector3d(1, 2, 3)).norm(), 1e-3);
  filter.end_contact();
  EXPECT_LT((filter.covariance() - prior).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_TRUE(filter.mean().tail<3>().isZero(0));
}

TEST(WrenchFilter, TakesNothingThatIsNotANumberAndAllocatesNothing) {
  WrenchFilter filter(2, {});
  WrenchFilter::Rows H = WrenchFilter::Rows::Random(12, filter.size());
  WrenchFilter::Wrenches y = WrenchFilter::Wrenches::Random(12);
  const WrenchFilter::Noise R = WrenchFilter::Noise::Identity(12, 12);
  const loop::NoAllocationScope scope;
  filter.predict(0.01);
  EXPECT_GE(filter.test(H, y, R), 0);
  filter.correct();
  EXPECT_TRUE(filter.mean().allFinite());
  y[3] = std::nan("");
  EXPECT_LT(filter.test(H, y, R), 0);
  H(2, 2) = HUGE_VAL;
  EXPECT_LT(filter.test(H, WrenchFilter::Wrenches::Zero(12), R), 0);
  EXPECT_EQ(scope.count(), 0);
}

TEST(WrenchFilter, RefusesWhatCannotBe) {
  EXPECT_THROW(WrenchFilter(0, {}), std::invalid_argument);
  EXPECT_THROW(WrenchFilter(3, {}), std::invalid_argument);
  WrenchFilter::Options options;
  options.memory = 0;
  EXPECT_THROW(WrenchFilter(1, options), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::estimation
