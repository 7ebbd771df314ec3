#include <gtest/gtest.h>

#include <cmath>

#include "tools/fit/experiments/beam.hpp"

namespace palpate::fit {
namespace {

TEST(Swing, FindsPeriodAndDecay) {
  const Eigen::VectorXd t = Eigen::VectorXd::LinSpaced(150, 0, 1.49);
  const double omega = 49, decay = 2.3, rest = -6.5e-3;
  const Eigen::VectorXd h =
      rest + 5e-3 * (-decay * t.array()).exp() * (omega * t.array() + 0.4).cos();
  const Swing swing = measure_swing(t, h, rest, 1e-4);
  EXPECT_GT(swing.half_periods, 10);
  EXPECT_NEAR(swing.period, 2 * M_PI / omega, 1e-4);
  EXPECT_NEAR(swing.decay, decay, 0.01 * decay);
}

TEST(Swing, SaysNothingOfWhatDoesNotSwing) {
  const Eigen::VectorXd t = Eigen::VectorXd::LinSpaced(50, 0, 1);
  EXPECT_EQ(measure_swing(t, (-t.array()).exp(), 0, 1e-4).half_periods, 0);
}

}  // namespace
}  // namespace palpate::fit
