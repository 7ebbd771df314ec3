#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "tests/unit/tools/fit/curve_experiment.hpp"
#include "tools/fit/fit.hpp"
#include "tools/fit/gradient_check.hpp"
#include "tools/fit/solver.hpp"
#include "tools/fit/uncertainty.hpp"

namespace palpate::fit {
namespace {

using Eigen::Vector2d;

std::shared_ptr<CurveExperiment> decaying(const std::string& name, const Vector2d& truth,
                                          double noise, math::Random& random, int held = 0) {
  auto experiment = std::make_shared<CurveExperiment>(name, decay_parameters(), decay);
  experiment->measure(truth, 40, noise, random, held);
  return experiment;
}

TEST(Solver, FindsWhatMadeTheDataFromAfar) {
  math::Random random(1);
  Problem problem({{decaying("a", {3, 0.2}, 0, random), {}, {}}}, {});
  const Fit fit = fit_problem(problem, {}, problem.start());
  EXPECT_NEAR(fit.find("height")->value, 3, 1e-6);
  EXPECT_NEAR(fit.find("length")->value, 0.2, 1e-6);
  EXPECT_TRUE(fit.solution.is_converged);
}

TEST(Solver, ParametersAreSharedByNameAndMayBeARecordingsOwn) {
  math::Random random(2);
  const auto a = decaying("a", {3, 0.2}, 0, random), b = decaying("b", {5, 0.2}, 0, random);
  Problem problem({{a, {"height"}, {}}, {b, {"height"}, {}}}, {});
  ASSERT_EQ(problem.parameters().size(), 3U);
  const Fit fit = fit_problem(problem, {}, problem.start());
  EXPECT_NEAR(fit.find("a.height")->value, 3, 1e-6);
  EXPECT_NEAR(fit.find("b.height")->value, 5, 1e-6);
  EXPECT_NEAR(fit.find("length")->value, 0.2, 1e-6);
  EXPECT_EQ(fit.find("height"), nullptr);
}

TEST(Solver, KnownBoundedAndUnknownNames) {
  math::Random random(3);
  const auto a = decaying("a", {3, 0.2}, 0.01, random);
  ParameterChange known, bounded;
  known.known = 0.2;
  bounded.upper = 2;
  Problem problem({{a, {}, {}}}, {{"length", known}, {"height", bounded}});
  EXPECT_EQ(problem.free().size(), 1U);
  const Fit fit = fit_problem(problem, {}, problem.start());
  EXPECT_EQ(fit.find("length")->standing, Standing::kKnown);
  EXPECT_EQ(fit.find("height")->standing, Standing::kAtBound);
  EXPECT_NEAR(fit.find("height")->value, 2, 1e-6);
  EXPECT_THROW(Problem({{a, {}, {}}}, {{"colour", known}}), std::invalid_argument);
  EXPECT_THROW(Problem({{a, {}, {}}}, {{"length", known}, {"height", known}}),
               std::invalid_argument);
}

TEST(Solver, HeldOutSamplesDoNotPullAndAreScored) {
  math::Random random(4);
  const auto a = decaying("a", {3, 0.2}, 0, random, 10);
  for (Eigen::Index i = 30; i < 40; ++i) a->mutable_series()[0].measured[i] += 1;
  Problem problem({{a, {}, {}}}, {});
  const Fit fit = fit_problem(problem, {}, problem.start());
  EXPECT_NEAR(fit.find("height")->value, 3, 1e-6);
  EXPECT_EQ(fit.series[0].fitted.count, 30);
  EXPECT_EQ(fit.series[0].held_out.count, 10);
  EXPECT_NEAR(fit.series[0].held_out.median, 1, 1e-6);
  EXPECT_NEAR(fit.series[0].held_out.rmse, 1, 1e-6);
}

TEST(Solver, RobustLossesBearOutliers) {
  math::Random random(5);
  const auto a = decaying("a", {3, 0.2}, 0.01, random);
  for (const Eigen::Index i : {3, 17, 31}) a->mutable_series()[0].measured[i] += 2;
  const auto error = [&](Loss::Kind kind) {
    Problem problem({{a, {}, {}}}, {});
    FitOptions options;
    options.solver.loss = {kind, 2};
    options.is_reweighed = false;
    return std::abs(fit_problem(problem, options, problem.start()).find("height")->value - 3);
  };
  const double plain = error(Loss::Kind::kNone);
  EXPECT_LT(error(Loss::Kind::kHuber), plain / 5);
  EXPECT_LT(error(Loss::Kind::kCauchy), plain / 20);
}

TEST(Solver, LossesHaveTheirOwnSlope) {
  for (const Loss loss : {Loss{Loss::Kind::kHuber, 1.5}, Loss{Loss::Kind::kCauchy, 1.5}})
    for (const double at : {-4.0, -0.5, 0.7, 1.49, 1.51, 6.0}) {
      double above = at + 1e-6, below = at - 1e-6, here = at;
      loss.apply(above);
      loss.apply(below);
      EXPECT_NEAR(loss.apply(here), (above - below) / 2e-6, 1e-6) << at;
      EXPECT_LE(std::abs(here), std::abs(at) + 1e-12);
    }
}

/// Many local minima: sin(b x) with b far from the start of the search.
TEST(Solver, ManyStartsFindADeeperValley) {
  const auto wave = [](const Eigen::VectorXd& p, double x, Eigen::VectorXd* by) {
    if (by) *by << std::cos(p[0] * x) * x;
    return std::sin(p[0] * x);
  };
  const std::vector<Parameter> parameters = {{"rate", "", 3, 1, 60, false}};
  math::Random random(6);
  const auto a = std::make_shared<CurveExperiment>("a", parameters, wave);
  a->measure(Eigen::VectorXd::Constant(1, 40), 100, 0.01, random);
  const auto rate = [&](int starts) {
    Problem problem({{a, {}, {}}}, {});
    FitOptions options;
    options.solver.starts = starts;
    return fit_problem(problem, options, problem.start()).find("rate")->value;
  };
  EXPECT_GT(std::abs(rate(1) - 40), 1);
  EXPECT_NEAR(rate(60), 40, 0.1);
  EXPECT_EQ(rate(60), rate(60));  // seeded
}

TEST(Solver, NumericDerivativesGiveTheSameWithMoreEvaluations) {
  math::Random random(7);
  const auto a = decaying("a", {3, 0.2}, 0.01, random);
  Problem analytic({{a, {}, {}}}, {}), numeric({{a, {}, {}}}, {});
  numeric.is_numeric = true;
  const Solution one = solve(analytic, {}, analytic.start());
  const Solution other = solve(numeric, {}, numeric.start());
  EXPECT_LT((one.coordinates - other.coordinates).norm(), 1e-5);
  EXPECT_GT(numeric.count().predictions,
            2 * (analytic.count().predictions + analytic.count().jacobians));
}

TEST(Solver, AWrongDerivativeIsFound) {
  math::Random random(8);
  const auto wrong = [](const Eigen::VectorXd& p, double x, Eigen::VectorXd* by) {
    const double y = decay(p, x, by);
    if (by) (*by)[1] *= 1 + 1e-5;
    return y;
  };
  for (const bool is_wrong : {false, true}) {
    auto a = std::make_shared<CurveExperiment>("a", decay_parameters(),
                                               is_wrong ? CurveExperiment::Curve(wrong) : decay);
    a->measure(Vector2d(3, 0.2), 40, 0.01, random);
    Problem problem({{a, {}, {}}}, {});
    const std::vector<GradientCheck> checks = check_gradients(problem, problem.start());
    ASSERT_EQ(checks.size(), 1U);
    if (is_wrong) {
      EXPECT_NEAR(checks[0].difference, 1e-5, 1e-7);
      EXPECT_EQ(checks[0].parameter, "length");
    } else {
      EXPECT_LT(checks[0].difference, 1e-10);
    }
  }
}

TEST(Solver, OnAKinkTheDerivativeOfEitherSideIsRight) {
  // Of a plate that touches at `length`, with a sample (5 of 0 to 40) exactly there.
  for (const double share : {0.0, 0.3, 1.0}) {
    const auto touching = [share](const Eigen::VectorXd& p, double x, Eigen::VectorXd* by) {
      const double depth = x - p[1];
      const double touches = std::abs(depth) < 1e-12 ? share : (depth > 0 ? 1 : 0);
      const double y = p[0] * std::max(0.0, depth) * (1 + std::max(0.0, depth));
      if (by) *by << (p[0] > 0 ? y / p[0] : 0), -touches * p[0] * (1 + 2 * std::max(0.0, depth));
      return y;
    };
    auto a = std::make_shared<CurveExperiment>("a", decay_parameters(),
                                               CurveExperiment::Curve(touching));
    math::Random random(10);
    a->measure(Vector2d(3, 0.125), 41, 0.01, random);
    Problem problem({{a, {}, {}}}, {{"length", {0.125, {}, {}, {}}}});
    const std::vector<GradientCheck> checks = check_gradients(problem, problem.start());
    ASSERT_EQ(checks.size(), 1U);
    if (share == 0.3) {
      EXPECT_GT(checks[0].difference, 0.01);
      EXPECT_EQ(checks[0].parameter, "length");
    } else {
      EXPECT_LT(checks[0].difference, 1e-9) << share;
    }
  }
}

TEST(Solver, AStartWithoutEquilibriumIsAnError) {
  const auto nowhere = [](const Eigen::VectorXd&, double, Eigen::VectorXd* by) {
    if (by) by->setZero();
    return std::nan("");
  };
  auto a = std::make_shared<CurveExperiment>("a", decay_parameters(), decay);
  math::Random random(9);
  a->measure(Vector2d(3, 0.2), 10, 0.01, random);
  const auto b = std::make_shared<CurveExperiment>("b", decay_parameters(), nowhere);
  b->mutable_series() = a->series();
  Problem problem({{b, {}, {}}}, {});
  EXPECT_THROW(solve(problem, {}, problem.start()), std::runtime_error);
}

}  // namespace
}  // namespace palpate::fit
