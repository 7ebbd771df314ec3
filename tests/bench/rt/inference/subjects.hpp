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
  int window;  // samples that the thesis computes anew for each answer
};

/// Networks of the thesis and of the presets that palpate-train has of its own.
std::vector<Network> networks();

sensing::RecurrentWeights random_weights(const Network& network);

/// The same cells as one call over the whole window, from zero, as in the thesis: a module of
/// inputs x window numbers and no state.
std::string windowed_module(const Network& network, const sensing::RecurrentWeights& weights);

/// Counts what a model allocates in the thread that runs it.
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

/// Answers nothing from the first step after `hangs` is set until it is cleared.
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
