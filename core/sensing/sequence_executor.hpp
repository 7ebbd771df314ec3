#pragma once

#include <cstdint>

namespace palpate::sensing {

/// Sizes of the input and output vectors of a learned model.
struct ModelSizes {
  int inputs = 0;
  int states = 0;
  int outputs = 0;
};

/// Status of an output.
enum class Answer {
  kFresh,  // output for the given sample
  kLate,   // output for an earlier sample; that of this sample comes later
  kNone,   // no output yet
  kFault,  // the model failed or hangs; latched until reset()
};

struct ExecutorCounters {
  std::int64_t steps = 0;    // samples received
  std::int64_t late = 0;     // samples whose output missed its deadline
  std::int64_t dropped = 0;  // samples never passed to the model
  std::int64_t faults = 0;
};

/// Runs a learned sequence model in the loop, one sample per step, and keeps its state. step() and
/// reset() neither allocate nor throw.
class Executor {
 public:
  virtual ~Executor() = default;
  virtual ModelSizes sizes() const noexcept = 0;
  /// Reads sizes().inputs numbers; writes sizes().outputs numbers, all finite, unless it returns
  /// kNone or kFault.
  virtual Answer step(const float* input, float* output) noexcept = 0;
  /// Starts a new sequence, also after a fault.
  virtual void reset() noexcept = 0;
  virtual ExecutorCounters counters() const noexcept = 0;
  /// "torch" or "compiled", as published in HEALTH.
  virtual const char* kind() const noexcept = 0;
};

}  // namespace palpate::sensing
