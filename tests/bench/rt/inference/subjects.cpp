#include "tests/bench/rt/inference/subjects.hpp"

#include <chrono>
#include <random>
#include <sstream>
#include <thread>

#include "rt/loop/allocation_counter.hpp"
#include "tests/support/torch_script/torch_script.hpp"

namespace palpate::bench {
namespace {

torch_script::Tensor tensor(const std::string& name, const Eigen::MatrixXf& matrix) {
  const Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows = matrix;
  return {name, {matrix.rows(), matrix.cols()}, {rows.data(), rows.data() + rows.size()}};
}

}  // namespace

std::vector<Network> networks() {
  return {{"thesis, tactile: 21 -> 20, 20 -> 3", 21, 3, {20, 20}, 50},
          {"thesis, wrist: 13 -> 15, 10 -> 6", 13, 6, {15, 10}, 20},
          {"palpate, tactile: 21 -> 12 -> 3", 21, 3, {12}, 50},
          {"palpate, wrist: 12 -> 15, 10 -> 6", 12, 6, {15, 10}, 20}};
}

sensing::RecurrentWeights random_weights(const Network& network) {
  std::mt19937 random(1);
  std::normal_distribution<float> normal(0, 0.2f);
  sensing::RecurrentWeights weights =
      sensing::RecurrentWeights::zero(network.inputs, network.outputs, network.layers);
  const auto fill = [&](Eigen::MatrixXf& part) {
    for (Eigen::Index i = 0; i < part.size(); ++i) part.data()[i] = normal(random);
  };
  for (sensing::LstmWeights& layer : weights.layers) {
    fill(layer.input);
    fill(layer.hidden);
  }
  fill(weights.dense);
  return weights;
}

std::string windowed_module(const Network& network, const sensing::RecurrentWeights& weights) {
  std::vector<torch_script::Tensor> parameters;
  std::ostringstream body;
  body << "h = x.reshape([1, " << network.window << ", " << network.inputs << "])\n";
  for (std::size_t k = 0; k < weights.layers.size(); ++k) {
    const sensing::LstmWeights& layer = weights.layers[k];
    const std::string name = "layer" + std::to_string(k);
    parameters.push_back(tensor(name + "_input", layer.input));
    parameters.push_back(tensor(name + "_hidden", layer.hidden));
    body << "zero" << k << " = torch.zeros([1, 1, " << layer.size() << "])\n"
         << "h, _a" << k << ", _b" << k << " = torch.lstm(h, [zero" << k << ", zero" << k
         << "], [self." << name << "_input, self." << name
         << "_hidden], False, 1, 0.0, False, False, True)\n";
  }
  parameters.push_back(tensor("dense", weights.dense));
  body << "return h[:, -1].matmul(self.dense.t()), state";
  return torch_script::module(torch_script::forward(body.str()), parameters);
}

bool Counted::step(const float* input, float* state, float* output) noexcept {
  const std::int64_t before = loop::allocations_of_this_thread();
  const bool good = model_->step(input, state, output);
  allocations_ += loop::allocations_of_this_thread() - before;
  return good;
}

bool Hanging::step(const float*, float*, float* output) noexcept {
  while (hangs_) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  output[0] = 0;
  return true;
}

}  // namespace palpate::bench
