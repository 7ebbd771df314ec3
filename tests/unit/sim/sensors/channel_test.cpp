#include "sim/sensors/channel.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace palpate::sensors {
namespace {

struct Arrival {
  std::int64_t sampled_us, taken_us;
};

/// Runs a channel on a grid of 1 ms.
std::vector<Arrival> run(const Timing& timing, int ticks) {
  Channel<std::int64_t> channel(timing, math::Random(3));
  std::vector<Arrival> arrivals;
  for (std::int64_t now = 1000; now <= 1000 * ticks; now += 1000) {
    if (channel.due(now)) channel.put(now, now);
    std::int64_t sample;
    while (channel.take(now, sample)) arrivals.push_back({sample, now});
  }
  return arrivals;
}

TEST(Channel, KeepsItsRateEvenWhereItDoesNotDivideTheTicks) {
  for (double rate : {1000.0, 500.0, 300.0, 100.0, 60.0}) {
    const auto arrivals = run({rate, 0, 0, 0}, 10000);
    EXPECT_NEAR(arrivals.size(), 10 * rate, 1) << rate;
    for (std::size_t i = 1; i < arrivals.size(); ++i) {
      const double gap = 1e-6 * (arrivals[i].sampled_us - arrivals[i - 1].sampled_us);
      EXPECT_NEAR(gap, 1 / rate, 1.001e-3) << rate;
    }
  }
}

TEST(Channel, DelaysByTheDelay) {
  for (const Arrival& a : run({500, 0.0035, 0, 0}, 1000))
    EXPECT_EQ(a.taken_us - a.sampled_us, 4000);  // the first tick at or after 3.5 ms
}

TEST(Channel, JitterKeepsTheOrderAndIsNeverEarly) {
  const auto arrivals = run({1000, 0.002, 0.003, 0}, 5000);
  ASSERT_GT(arrivals.size(), 4900u);
  bool late = false;
  for (std::size_t i = 0; i < arrivals.size(); ++i) {
    EXPECT_GE(arrivals[i].taken_us - arrivals[i].sampled_us, 2000);
    late = late || arrivals[i].taken_us - arrivals[i].sampled_us > 5000;
    if (i > 0) {
      EXPECT_LT(arrivals[i - 1].sampled_us, arrivals[i].sampled_us);
    }
  }
  EXPECT_TRUE(late);
}

TEST(Channel, LosesItsShareOfSamples) {
  const int n = 20000;
  const double lost = 1 - run({1000, 0, 0, 0.1}, n).size() / double(n);
  EXPECT_NEAR(lost, 0.1, 4 * std::sqrt(0.1 * 0.9 / n));
}

TEST(Signal, HasTheNoiseBiasAndStepOfItsTable) {
  const int n = 20000;
  const Faults faults{0.0125, 0.025, 0};
  const Eigen::Vector3d bias(0.5, -0.2, 0.03), value(1, 2, 3);
  Signal signal(faults, 1e-3, bias, math::Random(11));
  Eigen::Vector3d sum = Eigen::Vector3d::Zero(), squares = Eigen::Vector3d::Zero();
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector3d m = signal.measure(value);
    for (int a = 0; a < 3; ++a) {
      const double counts = m(a) / faults.step;
      ASSERT_NEAR(counts, std::round(counts), 1e-9);
    }
    sum += m;
    squares += (m - value - bias).cwiseAbs2();
  }
  // Quantisation adds step^2 / 12 to the variance.
  const double deviation = std::hypot(faults.noise, faults.step / std::sqrt(12));
  for (int a = 0; a < 3; ++a) {
    EXPECT_NEAR(sum(a) / n, value(a) + bias(a), 4 * deviation / std::sqrt(n));
    EXPECT_NEAR(std::sqrt(squares(a) / n), deviation, 4 * deviation / std::sqrt(2 * n));
  }
}

TEST(Signal, DriftsAsARandomWalk) {
  const double drift = 0.2, period = 0.01;
  double squares = 0;
  const int runs = 400;
  for (int r = 0; r < runs; ++r) {
    Signal signal({0, 0, drift}, period, Eigen::VectorXd::Zero(1), math::Random(r));
    Eigen::VectorXd last;
    for (int i = 0; i < 400; ++i) last = signal.measure(Eigen::VectorXd::Zero(1));  // 4 s
    squares += last(0) * last(0);
  }
  EXPECT_NEAR(std::sqrt(squares / runs), drift * 2, 4 * drift * 2 / std::sqrt(2 * runs));
}

TEST(Signal, WithoutFaultsIsTheTruth) {
  Signal signal({}, 1e-3, Eigen::VectorXd::Zero(2), math::Random(1));
  const Eigen::Vector2d value(0.123456789, -7);
  EXPECT_EQ(signal.measure(value), value);
}

}  // namespace
}  // namespace palpate::sensors
