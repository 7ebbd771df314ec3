#include "core/sensing/recurrent_network.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

namespace palpate::sensing {
namespace {

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument("recurrent network: " + what);
}

std::string shape(Eigen::Index rows, Eigen::Index cols) {
  return std::to_string(rows) + " x " + std::to_string(cols);
}

template <class M>
void check_part(const std::string& name, const M& part, Eigen::Index rows, Eigen::Index cols) {
  if (part.rows() != rows || part.cols() != cols)
    refuse(name + " is " + shape(part.rows(), part.cols()) + ", must be " + shape(rows, cols));
  if (!part.allFinite()) refuse(name + " holds a number that is not finite");
}

void check_count(const char* name, int count, int largest) {
  if (count < 1 || count > largest)
    refuse(std::to_string(count) + " " + name + "; allowed: 1 to " + std::to_string(largest));
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
  if (!((unit_mask.array() == 0) || (unit_mask.array() == 1)).all())
    refuse("unit_mask must hold 0 and 1 only");
  if (!(unit_floor > 0) || !std::isfinite(unit_floor)) refuse("unit_floor must be above 0");
  if (!(input_deviation.array() > 0).all()) refuse("input_deviation must be above 0");
  if (!(output_deviation.array() > 0).all()) refuse("output_deviation must be above 0");
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
