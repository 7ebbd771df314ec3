#pragma once

#include <memory>
#include <string>
#include <vector>

#include "rt/inference/sequence_model.hpp"

namespace palpate::inference {

struct TorchExecutorOptions {
  double wait = 200e-6;   // s that a step waits for its answer, 0 to 10
  double patience = 0.1;  // s without an answer to a sample after which the model is said to hang
  int depth = 16;         // samples and answers that may queue up, 1 to 1000
  int fifo_priority = 0;  // of the inference thread; 0: it stays SCHED_OTHER
  int cpu = -1;           // that it is bound to; -1: any
  /// Gets a line for each of the two that the system did not grant, unless it has that line.
  std::vector<std::string>* remarks = nullptr;
  int warm_up = 20;  // steps on zeros before the first sample, 0 to 1000
};

/// Runs a model, libtorch's as a rule since that allocates, on a thread of its own. The loop's side
/// hands over samples and takes answers without locks or allocation, and waits for the answer for
/// a bounded time. A late answer is taken by a later step and counted. Each sample is run, in
/// order, also those whose answers come late, so that the model's state misses none. Where wait and
/// patience are the same each answer is that of its sample, or there is a fault: then nothing that
/// comes of it depends on scheduling. A thread that hangs loses its real-time priority, so that it
/// starves nobody, until it has come back and reset() was called.
class TorchExecutor final : public Executor {
 public:
  /// To be made before the loop takes an affinity, which the thread would inherit. Throws
  /// std::invalid_argument for options out of range, std::runtime_error where the model fails or
  /// hangs while it warms up.
  explicit TorchExecutor(std::unique_ptr<SequenceModel> model,
                         const TorchExecutorOptions& options = {});
  /// Waits a second for the thread; one that hangs is left to itself, with all that it uses.
  ~TorchExecutor() override;
  TorchExecutor(const TorchExecutor&) = delete;
  TorchExecutor& operator=(const TorchExecutor&) = delete;

  ModelSizes sizes() const noexcept override;
  Answer step(const float* input, float* output) noexcept override;
  /// After a hang the model is usable again only once it has come back.
  void reset() noexcept override;
  ExecutorCounters counters() const noexcept override { return counters_; }
  const char* kind() const noexcept override;

 private:
  struct Shared;
  void report_refusals();
  void demote() noexcept;
  void leave() noexcept;
  std::shared_ptr<Shared> shared_;  // kept alive by a thread that hangs
  TorchExecutorOptions options_;
  ExecutorCounters counters_;
  std::int64_t given_ = 0;     // number of the last sample
  std::int64_t answered_ = 0;  // number of the sample whose answer was taken last
  std::int64_t since_ = 0;     // ns, when the oldest sample without an answer was given
  std::int64_t sequence_ = 0;  // raised by reset()
  bool failed_ = false;
  bool has_answer_ = false;  // of this sequence
  std::vector<float> last_;  // the answer taken last
};

}  // namespace palpate::inference
