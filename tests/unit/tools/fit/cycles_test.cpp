
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tools/fit/experiments/video.hpp"

namespace palpate::fit {
namespace {

constexpr double kTurn = 6.283185307179586;

/// (1 - cos) / 2 with a period of 2 s, at 100 Hz.
Eigen::VectorXd raised_cosine(const Eigen::VectorXd& time) {
  return (1 - (time.array() * kTurn / 2).cos()) / 2;
}

TEST(Cycles, HalvesGoFromTurnToTurn) {
  const Eigen::VectorXd time = Eigen::VectorXd::LinSpaced(601, 0, 6);
  const std::vector<HalfCycle> halves = half_cycles(raised_cosine(time));
  ASSERT_EQ(halves.size(), 6U);
  for (std::size_t k = 0; k < 6; ++k) {
    EXPECT_EQ(halves[k].first, static_cast<Eigen::Index>(100 * k));
    EXPECT_EQ(halves[k].last, static_cast<Eigen::Index>(100 * (k + 1)));
    EXPECT_EQ(halves[k].is_loading, k % 2 == 0);
  }
  EXPECT_EQ(after_cycles(raised_cosine(time), 0), 0);
  EXPECT_EQ(after_cycles(raised_cosine(time), 2), 400);
  EXPECT_EQ(after_cycles(raised_cosine(time), 3), 601);
}

TEST(Cycles, MeanCurveIsInTheMiddleOfTheHysteresis) {
  const Eigen::VectorXd time = Eigen::VectorXd::LinSpaced(6001, 0, 6);
  const Eigen::VectorXd strain = raised_cosine(time);
  // A load with hysteresis: above in loading, below in unloading; the first cycle is stiffer.
  Eigen::VectorXd load = 5 * strain.array() + 0.5 * (time.array() * kTurn / 2).sin();
  load.head(2000) *= 3;
  load[4500] = std::numeric_limits<double>::quiet_NaN();
  const MeanCurve curve = mean_curve(strain, load, 1, 11);
  EXPECT_EQ(curve.cycles, 2);
  for (Eigen::Index i = 1; i < 10; ++i)
    EXPECT_NEAR(curve.value[i], 5 * curve.strain[i], 0.02) << curve.strain[i];
  EXPECT_EQ(mean_curve(strain, load, 3, 11).cycles, 0);
}

TEST(Video, ItsClockIsSetByThePeaksOfStrain) {
  Eigen::VectorXd time = Eigen::VectorXd::LinSpaced(601, 0, 6);
  const Eigen::VectorXd other_time = Eigen::VectorXd::LinSpaced(180, 0, 5.97);
  // The camera started 0.37 s before the machine, and defines strain differently.
  const Eigen::VectorXd other = 0.3 * raised_cosine(other_time.array() - 0.37).array() + 0.01;
  double shift = 0, spread = 0;
  ASSERT_TRUE(find_shift(time, raised_cosine(time), other_time, other, shift, spread));
  EXPECT_NEAR(shift, -0.37, 0.02);
  EXPECT_LT(spread, 0.04);
  EXPECT_FALSE(find_shift(time, raised_cosine(time), other_time, 0 * other, shift, spread));
}

}  // namespace
}  // namespace palpate::fit
