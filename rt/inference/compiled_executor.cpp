#include "rt/inference/compiled_executor.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

namespace palpate::inference {

ModelSizes CompiledModel::sizes() const noexcept {
  return {network_.inputs(), network_.states(), network_.outputs()};
}

bool CompiledModel::step(const float* input, float* state, float* output) noexcept {
  network_.step(input, state, output);
  return std::all_of(output, output + network_.outputs(), [](float y) { return std::isfinite(y); });
}

DirectExecutor::DirectExecutor(std::unique_ptr<SequenceModel> model)
    : model_(std::move(model)), state_(model_->sizes().states, 0.f) {}

Answer DirectExecutor::step(const float* input, float* output) noexcept {
  ++counters_.steps;
  if (failed_) return Answer::kFault;
  if (model_->step(input, state_.data(), output)) return Answer::kFresh;
  failed_ = true;
  ++counters_.faults;
  return Answer::kFault;
}

void DirectExecutor::reset() noexcept {
  std::fill(state_.begin(), state_.end(), 0.f);
  failed_ = false;
}

double largest_difference(CompiledModel& compiled, SequenceModel& other, int steps, unsigned seed) {
  const ModelSizes sizes = compiled.sizes();
  const sensing::RecurrentWeights& weights = compiled.weights();
  std::vector<float> input(sizes.inputs);
  std::vector<float> states[2] = {std::vector<float>(sizes.states, 0.f),
                                  std::vector<float>(sizes.states, 0.f)};
  std::vector<float> outputs[2] = {std::vector<float>(sizes.outputs),
                                   std::vector<float>(sizes.outputs)};
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  double largest = 0;
  for (int k = 0; k < steps; ++k) {
    for (int i = 0; i < sizes.inputs; ++i)
      input[i] = weights.input_mean[i] + 2 * weights.input_deviation[i] * normal(random);
    if (!compiled.step(input.data(), states[0].data(), outputs[0].data()) ||
        !other.step(input.data(), states[1].data(), outputs[1].data()))
      throw std::runtime_error("a model fails on inputs like those of its training");
    for (int i = 0; i < sizes.outputs; ++i)
      largest = std::max(largest, std::abs(static_cast<double>(outputs[0][i]) - outputs[1][i]) /
                                      weights.output_deviation[i]);
  }
  return largest;
}

}  // namespace palpate::inference
