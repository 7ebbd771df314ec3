#pragma once

#include <memory>
#include <string>
#include <vector>

#include "rt/inference/sequence_model.hpp"

namespace palpate::inference {

struct TorchExecutorOptions {
  double wait = 200e-6;   // s, maximum wait of a step for its result, 0 to 10
  double patience = 0.1;  // s without a result after which the model counts as hanging
  int depth = 16;         // capacity of the queues of samples and results, 1 to 1000
  int fifo_priority = 0;  // of the inference thread; 0: SCHED_OTHER
  int cpu = -1;           // processor affinity; -1: any
  /// Receives a line for each of these two settings that the system rejected, unless it contains
  /// that line already.
  std::vector<std::string>* remarks = nullptr;
  int warm_up = 20;  // steps on zeros before the first sample, 0 to 1000
};

/// Runs a model in a separate thread, usually libtorch's, which allocates. The loop passes samples
/// and receives results without locks or allocation, and waits for a result for a bounded time. A
/// late result is used by a later step and counted. All samples are processed in order, including
/// those with late results, so that the model's state is complete. If wait and patience are equal,
/// each result belongs to its sample or there is a fault; results then do not depend on scheduling.
/// A hanging thread loses its real-time priority, so that it does not starve others, until it has
/// returned and reset() was called.
class TorchExecutor final : public Executor {
 public:
  /// Construct before the loop sets its affinity, which the thread would inherit. Throws
  /// std::invalid_argument for options out of range, std::runtime_error if the model fails or hangs
  /// during warm-up.
  explicit TorchExecutor(std::unique_ptr<SequenceModel> model,
                         const TorchExecutorOptions& options = {});
  /// Waits one second for the thread; a hanging one is detached together with its resources.
  ~TorchExecutor() override;
  TorchExecutor(const TorchExecutor&) = delete;
  TorchExecutor& operator=(const TorchExecutor&) = delete;

  ModelSizes sizes() const noexcept override;
  Answer step(const float* input, float* output) noexcept override;
  /// After a hang the model is usable again only once its thread has returned.
  void reset() noexcept override;
  ExecutorCounters counters() const noexcept override { return counters_; }
  const char* kind() const noexcept override;

 private:
  struct Shared;
  void report_refusals();
  void demote() noexcept;
  void leave() noexcept;
  std::shared_ptr<Shared> shared_;  // kept alive by a hanging thread
  TorchExecutorOptions options_;
  ExecutorCounters counters_;
  std::int64_t given_ = 0;     // number of the last sample
  std::int64_t answered_ = 0;  // number of the sample whose result was received last
  std::int64_t since_ = 0;     // ns, time of the oldest sample without a result
  std::int64_t sequence_ = 0;  // incremented by reset()
  bool failed_ = false;
  bool has_answer_ = false;  // a result of this sequence is available
  std::vector<float> last_;  // latest result
};

}  // namespace palpate::inference
