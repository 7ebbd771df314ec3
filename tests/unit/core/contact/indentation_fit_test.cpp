// Against the closed solutions of Hertz and of the flat punch, and against the spread of the result
// over many records.

#include "core/contact/indentation_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <random>
#include <stdexcept>

namespace palpate::contact {
namespace {

constexpr double kModulus = 30e3, kPoisson = 0.3;  // Pa
constexpr double kBall = 4e-3;                     // m

/// N, of a rigid ball in an elastic half-space (Hertz).
double hertz(double depth) {
  return 4.0 / 3 * kModulus / (1 - kPoisson * kPoisson) * std::sqrt(kBall) * std::pow(depth, 1.5);
}

struct Noise {
  double deviation = 0;    // N, of a sample
  double correlation = 0;  // of neighbouring samples
  double bias = 0;         // N
};

using Law = std::function<double(double)>;  // N, of the depth, m

/// 5 mm/s at 1 kHz until the force is `most`; returns the travel at the end.
double approach(ApproachRecord& record, double touch, double most, const Law& law,
                const Noise& noise = {}, unsigned seed = 1) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  double error = 0, travel = 0, smoothed = 0;
  for (; smoothed < most; travel += 5e-6) {
    const double fresh = std::sqrt(1 - std::pow(noise.correlation, 2)) * normal(generator);
    error = noise.correlation * error + fresh;
    const double depth = travel - touch;
    const double force = (depth > 0 ? law(depth) : 0) + noise.bias + noise.deviation * error;
    record.add(travel, force);
    smoothed += 0.05 * (force - smoothed);
    if (noise.deviation == 0) smoothed = force;
  }
  return travel - 5e-6;
}

IndentationFit::Result fit(const ApproachRecord& record,
                           const IndentationFit::Options& options = {}) {
  IndentationFit fit(options);
  fit.begin(record);
  int calls = 0;
  for (; !fit.done(); ++calls) fit.advance();
  EXPECT_LE(calls, 130);
  return fit.result();
}

TEST(IndentationFit, FindsTheTouchOfHertz) {
  ApproachRecord record(5e-5);
  const double touch = 0.0123, end = approach(record, touch, 0.5, hertz);
  const IndentationFit::Result result = fit(record);
  ASSERT_TRUE(result.valid) << result.reason;
  // Averages over steps of 50 um of a curve that bends.
  EXPECT_NEAR(result.touch, touch, 5e-6);
  EXPECT_NEAR(result.exponent, 1.5, 0.01);
  const double depth = end - touch;
  EXPECT_NEAR(depth, 3.2e-3, 0.1e-3) << "0.5 N on 30 kPa";
  EXPECT_NEAR(result.indentation, depth, 4e-5);
  EXPECT_NEAR(result.stiffness, hertz(depth) / depth, 0.02 * hertz(depth) / depth);
  EXPECT_NEAR(result.force, 0.5, 0.01);
}

TEST(IndentationFit, AFlatPunchHasTheExponentOne) {
  ApproachRecord record(5e-5);
  const double touch = 0.0123, stiffness = 260;  // N/m
  approach(record, touch, 0.5, [=](double depth) { return stiffness * depth; });
  IndentationFit::Options options;
  options.exponent = 1;
  options.exponent_deviation = 0;
  const IndentationFit::Result result = fit(record, options);
  ASSERT_TRUE(result.valid) << result.reason;
  EXPECT_NEAR(result.touch, touch, 5e-6);
  EXPECT_EQ(result.exponent, 1);
  EXPECT_NEAR(result.stiffness, stiffness, 1);
}

TEST(IndentationFit, AnOffsetOfTheForceDoesNotMoveTheTouch) {
  ApproachRecord record(5e-5);
  approach(record, 0.0123, 0.5, hertz, {0, 0, 0.05});
  const IndentationFit::Result result = fit(record);
  ASSERT_TRUE(result.valid) << result.reason;
  EXPECT_NEAR(result.touch, 0.0123, 3e-5);
}

struct Coverage {
  double touch = 0, stiffness = 0;  // fraction of the records within 1.96 deviations
  double error = 0, deviation = 0;  // m, root mean squares of the touch
  int valid = 0;
};

Coverage coverage(const Law& law, Noise noise, const IndentationFit::Options& options = {}) {
  constexpr int kRecords = 300;
  Coverage all;
  std::mt19937 generator(5);
  std::normal_distribution<double> normal;
  for (int seed = 0; seed < kRecords; ++seed) {
    ApproachRecord record(5e-5);
    const double touch = 0.012 + 2e-3 * normal(generator);
    noise.bias = 0.02 * normal(generator);
    approach(record, touch, 0.3, law, noise, static_cast<unsigned>(seed));
    const IndentationFit::Result result = fit(record, options);
    if (!result.valid) continue;
    ++all.valid;
    const double error = result.touch - touch;
    all.error += error * error;
    all.deviation += result.touch_deviation * result.touch_deviation;
    all.touch += std::abs(error) < 1.96 * result.touch_deviation;
    const double depth = result.touch + result.indentation - touch;
    all.stiffness +=
        std::abs(result.stiffness - law(depth) / depth) < 1.96 * result.stiffness_deviation;
  }
  all.touch /= all.valid;
  all.stiffness /= all.valid;
  all.error = std::sqrt(all.error / all.valid);
  all.deviation = std::sqrt(all.deviation / all.valid);
  std::printf("touch %.1f %%, stiffness %.1f %%, error %.3f mm, deviation %.3f mm, %d valid\n",
              100 * all.touch, 100 * all.stiffness, 1e3 * all.error, 1e3 * all.deviation,
              all.valid);
  return all;
}

TEST(IndentationFit, IntervalsHoldForWhiteNoise) {
  const Coverage found = coverage(hertz, {0.05, 0, 0});
  EXPECT_GE(found.valid, 297);
  EXPECT_GT(found.touch, 0.92);
  EXPECT_GT(found.stiffness, 0.91);
  EXPECT_LT(found.error, 0.2e-3);
  // The exponent here is that of the prior, so the deviation is rather too large.
  EXPECT_LT(found.deviation, 1.5 * found.error);
}

TEST(IndentationFit, IntervalsHoldForCorrelatedNoise) {
  const Coverage found = coverage(hertz, {0.04, 0.8, 0});
  EXPECT_GE(found.valid, 290);
  EXPECT_GT(found.touch, 0.90);
}

TEST(IndentationFit, OfAKnownExponentTheDeviationIsTheSpread) {
  IndentationFit::Options options;
  options.exponent_deviation = 0;
  const Coverage found = coverage(hertz, {0.05, 0, 0}, options);
  EXPECT_NEAR(found.error / found.deviation, 1, 0.15);
  EXPECT_NEAR(found.touch, 0.95, 0.035);
}

TEST(IndentationFit, AnotherExponentIsCoveredByItsPriorOnly) {
  const Law other = [](double depth) { return hertz(2e-3) * std::pow(depth / 2e-3, 1.25); };
  EXPECT_GT(coverage(other, {0.03, 0, 0}).touch, 0.88);
  IndentationFit::Options options;
  options.exponent_deviation = 0;
  EXPECT_LT(coverage(other, {0.03, 0, 0}, options).touch, 0.75);
}

TEST(IndentationFit, ThePlayOfTheSensorIsCorrectedAndCovered) {
  constexpr int kRecords = 300;
  constexpr double kPlay = 0.1;  // N
  IndentationFit::Options with;
  with.force_play = kPlay;
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> uniform(0, kPlay);
  double bias = 0, bias_without = 0;
  int covered = 0, covered_without = 0, valid = 0;
  for (unsigned seed = 0; seed < kRecords; ++seed) {
    ApproachRecord record(5e-5);
    const double touch = 0.012, p = uniform(generator);
    approach(
        record, touch, 0.3, [p](double depth) { return std::max(0.0, hertz(depth) - p); },
        {0.025, 0, 0}, seed);
    const IndentationFit::Result result = fit(record, with), without = fit(record);
    if (!result.valid || !without.valid) continue;
    ++valid;
    bias += result.touch - touch;
    bias_without += without.touch - touch;
    covered += std::abs(result.touch - touch) < 1.96 * result.touch_deviation;
    covered_without += std::abs(without.touch - touch) < 1.96 * without.touch_deviation;
  }
  std::printf(
      "touch too deep by %.3f mm, without correction %.3f mm; intervals hold: %.1f, %.1f %%\n",
      1e3 * bias / valid, 1e3 * bias_without / valid, 100.0 * covered / valid,
      100.0 * covered_without / valid);
  EXPECT_GE(valid, 290);
  EXPECT_LT(std::abs(bias), 0.25 * bias_without);
  EXPECT_GE(covered, 0.9 * valid);
  EXPECT_LT(covered_without, 0.7 * valid);
}

TEST(IndentationFit, SaysWhyThereIsNoResult) {
  const auto reason_of = [](double touch, const Law& law) {
    ApproachRecord record(5e-5);
    approach(record, touch, 0.3, law);
    const IndentationFit::Result result = fit(record);
    EXPECT_FALSE(result.valid);
    return std::string(result.reason);
  };
  EXPECT_NE(reason_of(0.01, [](double depth) { return 1e5 * depth; }).find("too few steps"),
            std::string::npos)
      << "a stiff surface";
  EXPECT_NE(reason_of(-0.004, hertz), "") << "in contact from the start";
  IndentationFit empty({});
  empty.begin(ApproachRecord(5e-5));
  EXPECT_TRUE(empty.done());
  EXPECT_FALSE(empty.result().valid);
}

TEST(IndentationFit, OptionsAreChecked) {
  const auto error_of = [](double exponent, double deviation, double bias) -> std::string {
    try {
      IndentationFit fit({exponent, deviation, bias});
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(error_of(1.5, 0.2, 0.03), "");
  EXPECT_NE(error_of(0.5, 0.2, 0.03).find("exponent: 0.5"), std::string::npos);
  EXPECT_NE(error_of(1.5, -1, 0.03).find("exponent_deviation"), std::string::npos);
  EXPECT_NE(error_of(1.5, 0.2, 0).find("bias_deviation"), std::string::npos);
}

}  // namespace
}  // namespace palpate::contact
