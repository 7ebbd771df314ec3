#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "core/math/team.hpp"

namespace palpate::loop {

struct SpinTeamOptions {
  int size = 2;              // number of members including the calling thread; 1 to 64
  int fifo_priority = 0;     // of the workers; 0: SCHED_OTHER
  std::vector<int> cpus;     // worker k is bound to the k-th entry, if present
  double patience = 200e-6;  // s without work after which a worker sleeps, 0 to 1
};

/// Team for work of a few microseconds: workers wait for it by spinning, and sleep after a time
/// without work, as between the ticks of a loop.
///
/// Runs are numbered. A share is executed by the first thread to claim it: its own worker or, if
/// that is still asleep or has been preempted, the calling thread after its own share. The calling
/// thread therefore waits only for shares that have begun, and a machine with fewer processors than
/// members only loses the speed-up. run() and call_up() neither allocate, lock nor throw; both make
/// a system call if workers must be woken, and run() yields its processor if it has to wait for
/// long.
class SpinTeam final : public math::Team {
 public:
  /// Construct before the loop sets its affinity, which workers would inherit. Throws
  /// std::invalid_argument for options out of range, std::system_error if no thread can be created.
  explicit SpinTeam(const SpinTeamOptions& options);
  ~SpinTeam() override;
  SpinTeam(const SpinTeam&) = delete;
  SpinTeam& operator=(const SpinTeam&) = delete;

  int size() const noexcept override { return size_; }
  void run(math::TeamTask task) noexcept override;
  void call_up() noexcept override;

  /// Settings that the system rejected for the workers, a line each; empty if all were granted.
  const std::string& remarks() const noexcept { return remarks_; }

 private:
  using Number = std::uint32_t;  // number of a run; wraps around
  /// State of a member, on a separate cache line.
  struct alignas(64) Post {
    std::atomic<Number> claimed{0};   // last run whose share was claimed
    std::atomic<Number> finished{0};  // last run whose share is finished
  };

  static bool claim(Post& post, Number number) noexcept;
  void await(const Post& post, Number number) const noexcept;
  void ring() noexcept;
  void stop() noexcept;
  // Main function of workers.
  void work(int member) noexcept;
  bool wait_for_work(Number seen) noexcept;
  void sleep(Number seen, std::uint32_t heard) noexcept;

  int size_;
  std::int64_t patience_ns_;
  bool is_crowded_;  // fewer processors than members
  std::string remarks_;
  std::unique_ptr<Post[]> posts_;
  std::vector<std::thread> threads_;
  math::TeamTask task_;  // task of the present run

  alignas(64) std::atomic<Number> number_{0};  // number of the last run
  std::atomic<bool> stop_{false};
  alignas(64) std::atomic<std::uint32_t> bell_{0};  // changes to wake sleeping workers
  std::atomic<int> sleepers_{0};
};

}  // namespace palpate::loop
