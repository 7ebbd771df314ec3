#include "tools/lab/sensor_models/observer_score.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace palpate::sensor_models {
namespace {

/// A contact force of 20 N along half a sine between 1 and 2 s, `lag` s late, off by `offset` N in
/// y.
ForceSeries push(double rate, double lag, double offset) {
  ForceSeries series;
  const int count = static_cast<int>(3 * rate);
  series.force.setZero(3, count);
  series.torque.setZero(3, count);
  for (int i = 0; i < count; ++i) {
    const double t = i / rate, inside = t - lag - 1;
    series.time.push_back(t);
    if (inside > 0 && inside < 1) series.force(0, i) = 20 * std::sin(M_PI * inside);
    series.force(1, i) = offset;
    series.torque(2, i) = -offset / 10;
  }
  return series;
}

TEST(ObserverScore, ResidualIsThatOfTheNorm) {
  ForceSeries felt = push(100, 10, 0.3);  // the contact starts after the end
  felt.force(2, 7) = 0.4;
  const ResidualScore score = score_residual(felt);
  EXPECT_NEAR(score.force_max, 0.5, 1e-12);
  EXPECT_NEAR(score.force_rms, std::sqrt((300 * 0.09 + 0.16) / 300), 1e-12);
  EXPECT_NEAR(score.torque_max, 0.03, 1e-12);
  EXPECT_NEAR(score.torque_rms, 0.03, 1e-12);
}

TEST(ObserverScore, AgreementIsFoundExact) {
  const TrackingScore score = score_tracking(push(1000, 0, 0), push(100, 0, 0));
  EXPECT_NEAR(score.peak, 20, 1e-9);
  EXPECT_LT(score.error_max, 1e-9);
  EXPECT_LT(score.peak_error, 1e-9);
  EXPECT_EQ(score.lag, 0);
}

TEST(ObserverScore, LagIsDistinguishedFromOffset) {
  const double lag = 0.02, offset = 0.5;
  const TrackingScore score = score_tracking(push(1000, lag, offset), push(100, 0, 0));
  EXPECT_NEAR(score.lag, lag, 1.5e-3);
  EXPECT_NEAR(score.lagged_rms, offset, 0.02);
  EXPECT_NEAR(score.lagged_max, offset, 0.05);
  // The force rises at first by 20 pi N/s.
  EXPECT_NEAR(score.error_max, std::hypot(20 * M_PI * lag, offset), 0.05);
  EXPECT_GT(score.error_rms, score.lagged_rms);
}

TEST(ObserverScore, NoContactIsAnError) {
  EXPECT_THROW(score_tracking(push(1000, 0, 0), push(100, 10, 0)), std::runtime_error);
}

}  // namespace
}  // namespace palpate::sensor_models
