#include "core/sensing/recurrent_network.hpp"

#include <cmath>
#include <string>

#include "core/math/option_check.hpp"

namespace palpate::sensing {
namespace {

std::string shape(Eigen::Index rows, Eigen::Index cols) {
  return std::to_string(rows) + " x " + std::to_string(cols);
}

template <class M>
void check_part(const std::string& name, const M& part, Eigen::Index rows, Eigen::Index cols) {
  math::check_option(part.rows() == rows && part.cols() == cols, name,
                     shape(part.rows(), part.cols()), shape(rows, cols));
  math::check_all_finite(part, name);
}

void check_count(const char* name, int count, int largest) {
  math::check_option(count >= 1 && count <= largest, name, count,
                     "1 to " + std::to_string(largest));
}

using Map = Eigen::Map<Eigen::VectorXf>;
using ConstMap = Eigen::Map<const Eigen::VectorXf>;

}  // namespace

int RecurrentWeights::states() const {
  int count = 0;
  for (const LstmWeights& layer : layers) count += 2 * layer.size();
  return count;
}

RecurrentWeights RecurrentWeights::zero(int inputs, int outputs,
                                        const std::vector<int>& layer_sizes) {
  RecurrentWeights weights;
  weights.unit_mask.setZero(inputs);
  weights.input_mean.setZero(inputs);
  weights.input_deviation.setOnes(inputs);
  int below = inputs;
  for (const int size : layer_sizes) {
    LstmWeights layer;
    layer.input.setZero(4 * size, below);
    layer.hidden.setZero(4 * size, size);
    layer.bias.setZero(4 * size);
    weights.layers.push_back(layer);
    below = size;
  }
  weights.dense.setZero(outputs, below);
  weights.linear.setZero(outputs, inputs);
  weights.offset.setZero(outputs);
  weights.output_mean.setZero(outputs);
  weights.output_deviation.setOnes(outputs);
  return weights;
}

void RecurrentWeights::check() const {
  check_count("inputs", inputs(), kLargestInputs);
  check_count("outputs", outputs(), kLargestOutputs);
  check_count("layers", static_cast<int>(layers.size()), kLargestLayers);
  check_part("unit_mask", unit_mask, inputs(), 1);
  check_part("input_mean", input_mean, inputs(), 1);
  check_part("input_deviation", input_deviation, inputs(), 1);
  int below = inputs();
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const std::string name = "lstm" + std::to_string(i);
    const int size = layers[i].size();
    check_count("cells in a layer", size, kLargestLayerSize);
    check_part(name + "_input", layers[i].input, 4 * size, below);
    check_part(name + "_hidden", layers[i].hidden, 4 * size, size);
    check_part(name + "_bias", layers[i].bias, 4 * size, 1);
    below = size;
  }
  check_part("dense", dense, outputs(), below);
  check_part("linear", linear, outputs(), inputs());
  check_part("offset", offset, outputs(), 1);
  check_part("output_mean", output_mean, outputs(), 1);
  check_part("output_deviation", output_deviation, outputs(), 1);
  math::check_option(((unit_mask.array() == 0) || (unit_mask.array() == 1)).all(), "unit_mask",
                     unit_mask.transpose(), "0, 1");
  math::check_positive_finite(unit_floor, "unit_floor");
  math::check_option((input_deviation.array() > 0).all(), "input_deviation",
                     input_deviation.transpose(), "above 0");
  math::check_option((output_deviation.array() > 0).all(), "output_deviation",
                     output_deviation.transpose(), "above 0");
}

RecurrentNetwork::RecurrentNetwork(const RecurrentWeights& weights) : weights_(weights) {
  weights_.check();
  states_ = weights_.states();
  int largest = 0;
  for (const LstmWeights& layer : weights_.layers) largest = std::max(largest, layer.size());
  scaled_.setZero(inputs());
  gates_.setZero(4 * largest);
  answer_.setZero(outputs());
}

void RecurrentNetwork::step(const float* input, float* state, float* output) noexcept {
  const RecurrentWeights& w = weights_;
  const ConstMap x(input, w.inputs());
  const float norm =
      std::sqrt((w.unit_mask.array() * x.array().square()).sum() + w.unit_floor * w.unit_floor);
  scaled_.array() =
      (x.array() * (1 - w.unit_mask.array() + w.unit_mask.array() / norm) - w.input_mean.array()) /
      w.input_deviation.array();

  const float* below = scaled_.data();
  int below_size = w.inputs();
  for (const LstmWeights& layer : w.layers) {
    const int n = layer.size();
    Map h(state, n);
    Map c(state + n, n);
    auto gates = gates_.head(4 * n);
    gates = layer.bias;
    gates.noalias() += layer.input * ConstMap(below, below_size);
    gates.noalias() += layer.hidden * h;
    c.array() = gates.segment(n, n).array().logistic() * c.array() +
                gates.head(n).array().logistic() * gates.segment(2 * n, n).array().tanh();
    h.array() = gates.tail(n).array().logistic() * c.array().tanh();
    below = state;
    below_size = n;
    state += 2 * n;
  }

  answer_ = w.offset;
  answer_.noalias() += w.dense * ConstMap(below, below_size);
  answer_.noalias() += w.linear * scaled_;
  Map(output, w.outputs()).array() =
      w.output_mean.array() + w.output_deviation.array() * answer_.array();
}

}  // namespace palpate::sensing
