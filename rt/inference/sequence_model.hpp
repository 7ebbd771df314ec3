#pragma once

#include "core/sensing/sequence_executor.hpp"

namespace palpate::inference {

using sensing::Answer;
using sensing::Executor;
using sensing::ExecutorCounters;
using sensing::ModelSizes;

/// A sensor model that is streamed: one sample in, one answer out, the state in the caller's hands.
/// Not for two threads at once.
class SequenceModel {
 public:
  virtual ~SequenceModel() = default;
  virtual ModelSizes sizes() const noexcept = 0;
  /// Zero is the state at the start of a sequence; the state is overwritten. False where the model
  /// failed or an output is not finite, which leaves output and state undefined.
  virtual bool step(const float* input, float* state, float* output) noexcept = 0;
  /// "torch" or "compiled", as HEALTH shows it.
  virtual const char* kind() const noexcept = 0;
};

}  // namespace palpate::inference
