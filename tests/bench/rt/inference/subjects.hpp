#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "core/sensing/recurrent_network.hpp"
#include "rt/inference/sequence_model.hpp"

namespace palpate::bench {

struct Network {
  const char* name;
  int inputs, outputs;
  std::vector<int> layers;
  int window;  // samples that the thesis evaluates again for each output
};

/// Networks of the thesis and of palpate-train's own presets.
std::vector<Network> networks();

sensing::RecurrentWeights random_weights(const Network& network);

/// The same cells as one call over the whole window, from zero, as in the thesis: a module with
/// inputs x window numbers and no state.
std::string windowed_module(const Network& network, const sensing::RecurrentWeights& weights);

/// Counts a model's allocations in the thread that runs it.
class Counted final : public inference::SequenceModel {
 public:
  Counted(std::unique_ptr<inference::SequenceModel> model, std::atomic<std::int64_t>& allocations)
      : model_(std::move(model)), allocations_(allocations) {}
  inference::ModelSizes sizes() const noexcept override { return model_->sizes(); }
  const char* kind() const noexcept override { return model_->kind(); }
  bool step(const float* input, float* state, float* output) noexcept override;

 private:
  std::unique_ptr<inference::SequenceModel> model_;
  std::atomic<std::int64_t>& allocations_;
};

/// Blocks from the first step after `hangs` is set until it is cleared.
class Hanging final : public inference::SequenceModel {
 public:
  explicit Hanging(const std::atomic<bool>& hangs) : hangs_(hangs) {}
  inference::ModelSizes sizes() const noexcept override { return {1, 1, 1}; }
  const char* kind() const noexcept override { return "hanging"; }
  bool step(const float* input, float* state, float* output) noexcept override;

 private:
  const std::atomic<bool>& hangs_;
};

}  // namespace palpate::bench
