#include "core/math/filter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>

#include "core/math/random.hpp"

namespace palpate::math {
namespace {

using Vector = Eigen::Vector2d;

TEST(MovingAverage, IsTheMeanOfTheLastSamples) {
  Random random(1);
  MovingAverage<2> average(7);
  std::deque<Vector> last;
  for (int k = 0; k < 100; ++k) {
    last.push_back({random.normal(), random.normal()});
    if (last.size() > 7) last.pop_front();
    Vector mean = Vector::Zero();
    for (const Vector& x : last) mean += x;
    mean /= static_cast<double>(last.size());
    EXPECT_LT((average.update(last.back()) - mean).norm(), 1e-14);
    EXPECT_EQ(average.full(), k >= 6);
  }
  average.reset();
  EXPECT_EQ(average.update({3, 4}), Vector(3, 4));
}

TEST(MovingAverage, ForgetsAnEnormousSampleWhole) {
  MovingAverage<1> average(5);
  using Scalar = Eigen::Matrix<double, 1, 1>;
  for (int k = 0; k < 8; ++k) average.update(Scalar(0.1));
  average.update(Scalar(1e17));
  for (int k = 0; k < 10; ++k) average.update(Scalar(0.1));
  EXPECT_NEAR(average.value()(0), 0.1, 1e-15);
}

TEST(ExponentialAverage, StepResponseIsGeometric) {
  const double alpha = 0.02;
  ExponentialAverage<2> average(alpha);
  average.update(Vector::Zero());
  for (int k = 1; k <= 200; ++k) {
    const Vector y = average.update({1, -2});
    const double expected = 1 - std::pow(1 - alpha, k);
    EXPECT_NEAR(y.x(), expected, 1e-14);
    EXPECT_NEAR(y.y(), -2 * expected, 1e-14);
  }
  average.reset();
  EXPECT_EQ(average.update({3, 4}), Vector(3, 4));
}

TEST(DelayLine, GivesWhatWentInEarlier) {
  for (const int delay : {0, 1, 6}) {
    DelayLine<2> line(delay);
    for (int k = 0; k < 30; ++k) {
      const Vector y = line.update({k, -k});
      EXPECT_EQ(y.x(), std::max(0, k - delay)) << delay;
      EXPECT_EQ(line.value(), y);
    }
  }
}

TEST(Filters, RefuseWrongSizes) {
  EXPECT_THROW(MovingAverage<2>(0), std::invalid_argument);
  EXPECT_THROW(ExponentialAverage<2>(0), std::invalid_argument);
  EXPECT_THROW(ExponentialAverage<2>(1.5), std::invalid_argument);
  EXPECT_THROW(ExponentialAverage<2>(std::nan("")), std::invalid_argument);
  EXPECT_THROW(DelayLine<2>(-1), std::invalid_argument);
}

TEST(Tare, IsTheMeanOfTheSamplesAfterTheStartAndKeepsTheFormerOneUntilThen) {
  Tare<2> tare(3);
  tare.update({100, 100});  // not started
  EXPECT_FALSE(tare.is_running());
  tare.start();
  for (const double x : {1.0, 2.0, 6.0}) {
    EXPECT_FALSE(tare.is_known());
    EXPECT_TRUE(tare.is_running());
    tare.update({x, -x});
  }
  EXPECT_TRUE(tare.is_known());
  EXPECT_FALSE(tare.is_running());
  EXPECT_EQ(tare.offset(), Vector(3, -3));
  tare.start();
  tare.update({9, 9});
  EXPECT_EQ(tare.offset(), Vector(3, -3));
  tare.set({4, 5});
  EXPECT_FALSE(tare.is_running());
  EXPECT_EQ(tare.offset(), Vector(4, 5));
  tare.reset();
  EXPECT_FALSE(tare.is_known());
  EXPECT_EQ(tare.offset(), Vector(0, 0));
  EXPECT_THROW(Tare<2>(0), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::math
