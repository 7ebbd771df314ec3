#include "core/sensing/recurrent_network.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/sensing/recurrent_observer_inputs.hpp"

namespace palpate::sensing {
namespace {

RecurrentWeights random_weights(unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal(0, 0.4f);
  const auto fill = [&](auto& part) {
    for (Eigen::Index i = 0; i < part.size(); ++i) part.data()[i] = normal(random);
  };
  RecurrentWeights w = RecurrentWeights::zero(5, 3, {4, 2});
  w.unit_mask << 0, 1, 1, 1, 0;
  w.unit_floor = 0.5f;
  fill(w.input_mean);
  w.input_deviation << 1, 0.5f, 0.25f, 2, 3;
  for (LstmWeights& layer : w.layers) {
    fill(layer.input);
    fill(layer.hidden);
    fill(layer.bias);
  }
  fill(w.dense);
  fill(w.linear);
  fill(w.offset);
  fill(w.output_mean);
  w.output_deviation << 2, 0.1f, 1;
  return w;
}

double sigmoid(double v) { return 1 / (1 + std::exp(-v)); }

/// The formulas of the header, one number at a time in double.
struct Plain {
  const RecurrentWeights& w;
  std::vector<std::vector<double>> h, c;

  explicit Plain(const RecurrentWeights& weights) : w(weights) {
    for (const LstmWeights& layer : w.layers) {
      h.emplace_back(layer.size(), 0.0);
      c.emplace_back(layer.size(), 0.0);
    }
  }

  std::vector<double> step(const std::vector<float>& x) {
    double square = static_cast<double>(w.unit_floor) * w.unit_floor;
    for (int i = 0; i < w.inputs(); ++i)
      if (w.unit_mask[i] == 1) square += static_cast<double>(x[i]) * x[i];
    std::vector<double> z;
    for (int i = 0; i < w.inputs(); ++i) {
      const double scaled = w.unit_mask[i] == 1 ? x[i] / std::sqrt(square) : x[i];
      z.push_back((scaled - w.input_mean[i]) / w.input_deviation[i]);
    }
    std::vector<double> below = z;
    for (std::size_t k = 0; k < w.layers.size(); ++k) {
      const LstmWeights& layer = w.layers[k];
      const int n = layer.size();
      const auto gate = [&](int row) {
        double sum = layer.bias[row];
        for (std::size_t i = 0; i < below.size(); ++i)
          sum += static_cast<double>(layer.input(row, static_cast<int>(i))) * below[i];
        for (int i = 0; i < n; ++i) sum += static_cast<double>(layer.hidden(row, i)) * h[k][i];
        return sum;
      };
      std::vector<double> next_h(n), next_c(n);
      for (int j = 0; j < n; ++j) {
        next_c[j] = sigmoid(gate(n + j)) * c[k][j] + sigmoid(gate(j)) * std::tanh(gate(2 * n + j));
        next_h[j] = sigmoid(gate(3 * n + j)) * std::tanh(next_c[j]);
      }
      h[k] = next_h;
      c[k] = next_c;
      below = next_h;
    }
    std::vector<double> y;
    for (int o = 0; o < w.outputs(); ++o) {
      double sum = w.offset[o];
      for (std::size_t i = 0; i < below.size(); ++i)
        sum += static_cast<double>(w.dense(o, static_cast<int>(i))) * below[i];
      for (std::size_t i = 0; i < z.size(); ++i)
        sum += static_cast<double>(w.linear(o, static_cast<int>(i))) * z[i];
      y.push_back(w.output_mean[o] + w.output_deviation[o] * sum);
    }
    return y;
  }
};

TEST(RecurrentNetwork, FollowsTheFormulasNumberByNumber) {
  const RecurrentWeights weights = random_weights(3);
  RecurrentNetwork network(weights);
  ASSERT_EQ(network.states(), 2 * (4 + 2));
  Plain plain(weights);
  std::vector<float> state(network.states(), 0.f), y(3), x(5);
  std::mt19937 random(5);
  std::normal_distribution<float> normal(0, 2);
  for (int k = 0; k < 300; ++k) {
    for (float& v : x) v = normal(random);
    network.step(x.data(), state.data(), y.data());
    const std::vector<double> expected = plain.step(x);
    for (int o = 0; o < 3; ++o)
      ASSERT_NEAR(y[o], expected[o], 1e-5 * weights.output_deviation[o]) << "step " << k;
  }
}

TEST(RecurrentNetwork, GoesOnGrowingAlongTheLinearPathWhereCellsSaturate) {
  RecurrentWeights weights = random_weights(4);
  weights.unit_mask.setZero();
  RecurrentNetwork network(weights);
  const auto answer = [&](float size) {
    const std::vector<float> x(5, size);
    std::vector<float> state(network.states(), 0.f);
    Eigen::VectorXf y(3);
    network.step(x.data(), state.data(), y.data());
    return y;
  };
  const Eigen::VectorXf slope = (answer(2e3f) - answer(1e3f)) / 1e3f;
  const Eigen::VectorXf expected = weights.output_deviation.cwiseProduct(
      weights.linear * weights.input_deviation.cwiseInverse());
  EXPECT_TRUE(slope.isApprox(expected, 1e-3f)) << slope.transpose() << "\n" << expected.transpose();
}

TEST(RecurrentNetwork, UnitLengthMakesTheAnswerIndependentOfStrength) {
  RecurrentWeights weights = random_weights(4);
  weights.unit_floor = 1e-6f;
  RecurrentNetwork network(weights);
  std::vector<float> weak{0.3f, 1, -2, 0.5f, 0.1f}, strong{0.3f, 50, -100, 25, 0.1f};
  std::vector<float> a(3), b(3);
  std::vector<float> state(network.states(), 0.f);
  network.step(weak.data(), state.data(), a.data());
  std::fill(state.begin(), state.end(), 0.f);
  network.step(strong.data(), state.data(), b.data());
  for (int o = 0; o < 3; ++o) EXPECT_NEAR(a[o], b[o], 1e-5);
}

TEST(RecurrentNetwork, RejectsWrongWeightsNamingThemAndTheirValues) {
  const auto complaint = [](const auto& spoil) -> std::string {
    RecurrentWeights weights = random_weights(1);
    spoil(weights);
    try {
      RecurrentNetwork network(weights);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  using W = RecurrentWeights;
  EXPECT_EQ(complaint([](W&) {}), "accepted");
  EXPECT_EQ(complaint([](W& w) { w.dense.resize(3, 4); }).rfind("dense: 3 x 4; allowed: 3 x 2", 0),
            0u);
  EXPECT_EQ(
      complaint([](W& w) { w.layers[1].hidden(0, 0) = std::nanf(""); }).rfind("lstm1_hidden: ", 0),
      0u);
  EXPECT_EQ(complaint([](W& w) { w.layers.clear(); }).rfind("layers: 0; allowed: 1 to 8", 0), 0u);
  EXPECT_EQ(complaint([](W& w) { w.input_deviation[2] = 0; }).rfind("input_deviation: ", 0), 0u);
  EXPECT_EQ(complaint([](W& w) { w.unit_mask[0] = 0.5f; }).rfind("unit_mask: 0.5 ", 0), 0u);
  EXPECT_EQ(complaint([](W& w) {
              w.unit_floor = std::numeric_limits<float>::infinity();
            }).rfind("unit_floor: inf", 0),
            0u);
}

TEST(ObserverInputs, NamesAndIndicesGoTogether) {
  for (int i = 0; i < kObserverInputCount; ++i) {
    EXPECT_EQ(observer_input_index(observer_input_name(i)), i);
    EXPECT_STRNE(observer_input_unit(i), "");
  }
  EXPECT_EQ(observer_input_index("gravity"), -1);
  EXPECT_STREQ(observer_input_name(kObserverInputCount), "");
}

TEST(ObserverInputs, TurnWithTheSensorAndKeepTheQuaternionsSign) {
  const math::Pose X_WS = math::make_pose(math::exp_rotation({0, 0, M_PI / 2}), {7, 8, 9});
  LoadMotion motion;
  motion.angular_velocity = {1, 0, 0};
  motion.specific_force = {4, 5, 6};
  const Eigen::Vector3d gravity(0, 0, -9.81);
  const ObserverInputs inputs =
      observer_inputs(X_WS, {0, 2, 0}, motion, gravity, Eigen::Vector4d::Zero());
  EXPECT_TRUE(inputs.segment<3>(7).isApprox(Eigen::Vector3d(0, 1, 0)));    // angular velocity in W
  EXPECT_TRUE(inputs.segment<3>(16).isApprox(Eigen::Vector3d(2, 0, 0)));   // velocity in S
  EXPECT_TRUE(inputs.segment<3>(13).isApprox(Eigen::Vector3d(0, 0, -1)));  // gravity in S
  EXPECT_TRUE(inputs.segment<3>(10).isApprox(Eigen::Vector3d(4, 5, 6)));
  EXPECT_TRUE(inputs.segment<3>(25).isApprox(Eigen::Vector3d(7, 8, 9)));
  EXPECT_GT(inputs[3], 0);
  const Eigen::Vector4d other = -inputs.head<4>();
  EXPECT_TRUE(observer_inputs(X_WS, {0, 2, 0}, motion, gravity, other).head<4>().isApprox(other));
}

}  // namespace
}  // namespace palpate::sensing
