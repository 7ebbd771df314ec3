#include "core/sensing/ft_rnnob.hpp"

#include <gtest/gtest.h>

namespace palpate::sensing {
namespace {

using Row = Eigen::Vector2d;

/// Row k of a ramp and of its square.
Row ramp(int k) { return {1.0 * k, 1.0 * k * k}; }

TEST(SignalHistory, DelaysByAFractionAndAverages) {
  SignalHistory history(2, 4, 3.5);
  for (int k = 0; k <= 50; ++k) history.push(ramp(k));
  Row mean;
  history.mean(0, 0, mean);
  EXPECT_NEAR(mean[0], 48.5, 1e-12);  // of 47 to 50
  EXPECT_NEAR(mean[1], (47 * 47 + 48 * 48 + 49 * 49 + 50 * 50) / 4.0, 1e-9);
  history.mean(0, 3.25, mean);
  EXPECT_NEAR(mean[0], 48.5 - 3.25, 1e-12);
  Eigen::Matrix<double, 1, 1> second;
  history.mean(1, 0, second);
  EXPECT_EQ(second[0], (47 * 47 + 48 * 48 + 49 * 49 + 50 * 50) / 4.0);
}

TEST(SignalHistory, TheFirstRowStandsForWhatWasBefore) {
  SignalHistory history(2, 4, 2);
  Row mean = Row::Ones();
  history.mean(0, 1, mean);
  EXPECT_EQ(mean, Row::Zero());
  history.push(Row(8, 1));
  history.push(Row(2, 1));
  history.mean(0, 0, mean);
  EXPECT_EQ(mean[0], 5);
  history.mean(0, 1, mean);
  EXPECT_EQ(mean[0], 8);
  history.clear();
  history.push(Row(3, 1));
  history.mean(0, 2, mean);
  EXPECT_EQ(mean[0], 3);
}

TEST(SignalHistory, RefusesWhatIsOutOfRange) {
  EXPECT_THROW(SignalHistory(0, 1, 0), std::invalid_argument);
  EXPECT_THROW(SignalHistory(1, 0, 0), std::invalid_argument);
  EXPECT_THROW(SignalHistory(1, 1, -1), std::invalid_argument);
  EXPECT_THROW(SignalHistory(1, 1, 1e7), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::sensing
