#pragma once

#include <atomic>
#include <thread>

#include <semaphore.h>

namespace palpate::loop {

/// Low-priority thread that runs one job at a time for the loop. The loop neither locks nor
/// allocates: submit() passes a pointer and posts a semaphore; finished() polls.
class BackgroundWorker {
 public:
  using Job = void (*)(void* argument) noexcept;

  /// Construct before the loop sets its affinity, which the worker would inherit.
  BackgroundWorker();
  /// Waits for a running job; a job that has not started is discarded.
  ~BackgroundWorker();
  BackgroundWorker(const BackgroundWorker&) = delete;
  BackgroundWorker& operator=(const BackgroundWorker&) = delete;

  /// False while a job is running or its completion has not been collected.
  bool submit(Job job, void* argument) noexcept;
  /// Returns the argument of the finished job once, then nullptr until another has finished.
  void* finished() noexcept;
  /// The same, but waits for a running job. Not for a real-time loop.
  void* wait() noexcept;
  bool busy() const noexcept;

 private:
  void work() noexcept;
  enum State : int { kIdle, kRunning, kFinished };
  std::atomic<int> state_{kIdle};
  std::atomic<bool> stop_{false};
  Job job_ = nullptr;
  void* argument_ = nullptr;
  sem_t wake_;
  sem_t ended_;  // posted after each job
  std::thread thread_;
};

}  // namespace palpate::loop
