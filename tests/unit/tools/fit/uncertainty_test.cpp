#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "tests/unit/tools/fit/curve_experiment.hpp"
#include "tools/fit/fit.hpp"
#include "tools/fit/uncertainty.hpp"

namespace palpate::fit {
namespace {

double line(const Eigen::VectorXd& p, double x, Eigen::VectorXd* by) {
  if (by) *by << 1, x;
  return p[0] + p[1] * x;
}

const std::vector<Parameter> kLine = {{"level", "m", 0, -10, 10, false},
                                      {"slope", "m", 0, -10, 10, false}};

TEST(Uncertainty, OfAStraightLineIsThatOfTheTextbook) {
  math::Random random(1);
  auto a = std::make_shared<CurveExperiment>("a", kLine, line);
  a->measure(Eigen::Vector2d(1, 2), 25, 0.1, random);
  Problem problem({{a, {}, {}}}, {});
  const Fit fit = fit_problem(problem, {}, problem.start());

  Eigen::MatrixXd X(25, 2);
  X.col(0).setOnes();
  X.col(1) = a->series()[0].x;
  const Eigen::VectorXd best = X.colPivHouseholderQr().solve(a->series()[0].measured);
  const double variance = (X * best - a->series()[0].measured).squaredNorm() / 23;
  const Eigen::MatrixXd C = variance * (X.transpose() * X).inverse();
  ASSERT_EQ(fit.uncertainty.noise[0].factor, 1);
  EXPECT_NEAR(fit.find("slope")->value, best[1], 1e-6);
  EXPECT_LT((fit.uncertainty.covariance - C).norm(), 1e-5 * C.norm());
  EXPECT_NEAR(fit.uncertainty.correlation(0, 1), C(0, 1) / std::sqrt(C(0, 0) * C(1, 1)), 1e-6);
  // Student's t of 23 degrees of freedom.
  const double t = 2.0687;
  EXPECT_NEAR(fit.find("slope")->interval[1], best[1] + t * std::sqrt(C(1, 1)), 1e-4);
  EXPECT_FALSE(fit.find("slope")->is_profile);
  EXPECT_NEAR(fit.uncertainty.noise[0].deviation, std::sqrt(variance), 1e-7);
}

TEST(Uncertainty, IntervalsCoverTheTruthIn200Seeds) {
  constexpr int kSeeds = 200;
  const Eigen::Vector2d truth(3, 0.4);
  int height = 0, length = 0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    math::Random random(static_cast<std::uint64_t>(seed), "coverage");
    auto a = std::make_shared<CurveExperiment>("a", decay_parameters(), decay);
    a->measure(truth, 30, 0.2, random);
    Problem problem({{a, {}, {}}}, {});
    const Fit fit = fit_problem(problem, {}, problem.start());
    const auto covers = [&](const char* name, double value) {
      const auto& interval = fit.find(name)->interval;
      return interval[0] <= value && value <= interval[1] ? 1 : 0;
    };
    height += covers("height", truth[0]);
    length += covers("length", truth[1]);
  }
  for (const int covered : {height, length}) {
    EXPECT_GE(covered, 180);
    EXPECT_LE(covered, 198);
  }
}

/// Noise of a first-order process: the textbook factor is (1 + r) / (1 - r).
TEST(Uncertainty, AutocorrelatedNoiseWidensIntervals) {
  constexpr double kMemory = 0.8;
  math::Random random(3);
  Eigen::VectorXd noise(4000);
  double state = 0;
  for (double& value : noise) value = state = kMemory * state + random.normal();
  const double expected = (1 + kMemory) / (1 - kMemory);
  EXPECT_NEAR(autocorrelation_factor(noise), expected, 0.25 * expected);
  for (double& value : noise) value = random.normal();
  EXPECT_LT(autocorrelation_factor(noise), 1.1);

  int covered = 0;
  constexpr int kSeeds = 100;
  for (int seed = 0; seed < kSeeds; ++seed) {
    math::Random one(static_cast<std::uint64_t>(seed), "memory");
    auto a = std::make_shared<CurveExperiment>("a", kLine, line);
    a->measure(Eigen::Vector2d(1, 2), 400, 0, one);
    double now = 0;
    for (double& value : a->mutable_series()[0].measured)
      value += now = kMemory * now + 0.1 * one.normal();
    Problem problem({{a, {}, {}}}, {});
    const auto interval = fit_problem(problem, {}, problem.start()).find("slope")->interval;
    covered += interval[0] <= 2 && 2 <= interval[1] ? 1 : 0;
  }
  EXPECT_GE(covered, 85);
}

TEST(Uncertainty, UndeterminedDirectionsAreNamed) {
  // a b x: only the product is identifiable.
  const auto product = [](const Eigen::VectorXd& p, double x, Eigen::VectorXd* by) {
    if (by) *by << p[1] * x, p[0] * x, 1;
    return p[0] * p[1] * x + p[2];
  };
  math::Random random(4);
  auto a = std::make_shared<CurveExperiment>(
      "a",
      std::vector<Parameter>{
          {"a", "", 1, 1e-3, 1e3, true}, {"b", "", 1, 1e-3, 1e3, true}, {"c", "", 0, -9, 9, false}},
      product);
  a->measure(Eigen::Vector3d(2, 3, 1), 50, 0.01, random);
  Problem problem({{a, {}, {}}}, {});
  const Fit fit = fit_problem(problem, {}, problem.start());
  EXPECT_EQ(fit.find("a")->standing, Standing::kUndetermined);
  EXPECT_EQ(fit.find("b")->standing, Standing::kUndetermined);
  EXPECT_EQ(fit.find("c")->standing, Standing::kEstimated);
  EXPECT_NEAR(fit.find("c")->value, 1, 0.02);
  ASSERT_EQ(fit.uncertainty.open.size(), 1U);
  ASSERT_EQ(fit.uncertainty.open[0].shares.size(), 2U);
  // One may increase as the other decreases.
  EXPECT_NEAR(fit.uncertainty.open[0].shares[0].second, -fit.uncertainty.open[0].shares[1].second,
              1e-3);
}

TEST(Uncertainty, ProfileTakesOverWhereCurvatureMisleads) {
  // The cube of a level, which a second-order approximation does not represent.
  const auto cube = [](const Eigen::VectorXd& p, double, Eigen::VectorXd* by) {
    if (by) *by << 3 * p[0] * p[0];
    return p[0] * p[0] * p[0];
  };
  math::Random random(5);
  auto a = std::make_shared<CurveExperiment>(
      "a", std::vector<Parameter>{{"root", "", 1, 0, 2, false}}, cube);
  a->measure(Eigen::VectorXd::Constant(1, 0.5), 20, 0.2, random);
  Problem problem({{a, {}, {}}}, {});
  const Fit fit = fit_problem(problem, {}, problem.start());
  const Estimate& root = *fit.find("root");
  ASSERT_TRUE(root.is_profile);
  // The mean's interval, of which the root's are the ends.
  const Eigen::VectorXd& y = a->series()[0].measured;
  const double mean = y.mean(), deviation = std::sqrt((y.array() - mean).square().sum() / 19 / 20);
  EXPECT_NEAR(root.interval[0], std::cbrt(std::max(0.0, mean - 2.093 * deviation)), 0.01);
  EXPECT_NEAR(root.interval[1], std::cbrt(mean + 2.093 * deviation), 0.01);
  FitOptions never;
  never.profile = Profile::kNever;
  EXPECT_FALSE(fit_problem(problem, never, problem.start()).find("root")->is_profile);
}

TEST(Uncertainty, StudentsQuantilesAreThoseOfTheTable) {
  EXPECT_NEAR(student_quantile(1), 12.706, 1e-3);
  EXPECT_NEAR(student_quantile(4), 2.776, 1e-3);
  EXPECT_NEAR(student_quantile(10), 2.228, 1e-3);
  EXPECT_NEAR(student_quantile(1e6), 1.960, 1e-3);
}

}  // namespace
}  // namespace palpate::fit
