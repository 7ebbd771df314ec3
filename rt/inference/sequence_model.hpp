#pragma once

#include "core/sensing/sequence_executor.hpp"

namespace palpate::inference {

using sensing::Answer;
using sensing::Executor;
using sensing::ExecutorCounters;
using sensing::ModelSizes;

/// Streaming sensor model: one sample in, one output out; the caller keeps the state. Not
/// thread-safe.
class SequenceModel {
 public:
  virtual ~SequenceModel() = default;
  virtual ModelSizes sizes() const noexcept = 0;
  /// Zero is the initial state of a sequence; the state is overwritten. False if the model failed
  /// or an output is not finite; output and state are then undefined.
  virtual bool step(const float* input, float* state, float* output) noexcept = 0;
  /// "torch" or "compiled", as published in HEALTH.
  virtual const char* kind() const noexcept = 0;
};

}  // namespace palpate::inference
