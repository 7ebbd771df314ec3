#pragma once

#include <cstdint>

namespace palpate::sensing {

/// Sizes of the vectors that a learned model takes and gives.
struct ModelSizes {
  int inputs = 0;
  int states = 0;
  int outputs = 0;
};

/// How an answer came about.
enum class Answer {
  kFresh,  // it is that of the sample given
  kLate,   // it is that of an earlier sample; this one's comes later
  kNone,   // there is none yet
  kFault,  // the model failed or hangs; it stays so until reset()
};

struct ExecutorCounters {
  std::int64_t steps = 0;    // samples given
  std::int64_t late = 0;     // of them, without their answer in time
  std::int64_t dropped = 0;  // of them, never seen by the model
  std::int64_t faults = 0;
};

/// Runs a learned model of sequences for the loop, one sample a step, and keeps its state. step()
/// and reset() neither allocate nor throw.
class Executor {
 public:
  virtual ~Executor() = default;
  virtual ModelSizes sizes() const noexcept = 0;
  /// Takes sizes().inputs numbers; writes sizes().outputs of them, all finite, unless it says kNone
  /// or kFault.
  virtual Answer step(const float* input, float* output) noexcept = 0;
  /// Begins a new sequence, after a fault also.
  virtual void reset() noexcept = 0;
  virtual ExecutorCounters counters() const noexcept = 0;
  /// "torch" or "compiled", as HEALTH shows it.
  virtual const char* kind() const noexcept = 0;
};

}  // namespace palpate::sensing
