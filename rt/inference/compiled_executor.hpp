#pragma once

#include <memory>
#include <vector>

#include "core/sensing/recurrent_network.hpp"
#include "rt/inference/sequence_model.hpp"

namespace palpate::inference {

/// Network kernel without libtorch and without allocation.
class CompiledModel final : public SequenceModel {
 public:
  /// Throws std::invalid_argument as RecurrentWeights::check.
  explicit CompiledModel(const sensing::RecurrentWeights& weights) : network_(weights) {}
  ModelSizes sizes() const noexcept override;
  bool step(const float* input, float* state, float* output) noexcept override;
  const char* kind() const noexcept override { return "compiled"; }
  const sensing::RecurrentWeights& weights() const noexcept { return network_.weights(); }

 private:
  sensing::RecurrentNetwork network_;
};

/// Runs a model in the caller's thread.
class DirectExecutor final : public Executor {
 public:
  explicit DirectExecutor(std::unique_ptr<SequenceModel> model);
  ModelSizes sizes() const noexcept override { return model_->sizes(); }
  Answer step(const float* input, float* output) noexcept override;
  void reset() noexcept override;
  ExecutorCounters counters() const noexcept override { return counters_; }
  const char* kind() const noexcept override { return model_->kind(); }

 private:
  std::unique_ptr<SequenceModel> model_;
  std::vector<float> state_;
  bool failed_ = false;
  ExecutorCounters counters_;
};

/// Largest difference between the outputs of two models over `steps` random samples in sequence, in
/// units of output_deviation. The samples are normal, with the mean and twice the standard
/// deviation of the training data, reproducible by seed. Throws std::runtime_error if a model
/// fails.
double largest_difference(CompiledModel& compiled, SequenceModel& other, int steps = 200,
                          unsigned seed = 1);

/// Maximum such difference of a compiled model from libtorch.
inline constexpr double kAgreement = 1e-5;

}  // namespace palpate::inference
