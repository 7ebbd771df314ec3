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
  int size = 2;              // members, the calling thread among them; 1 to 64
  int fifo_priority = 0;     // of the workers; 0: they stay SCHED_OTHER
  std::vector<int> cpus;     // worker k is bound to the k-th, where there is one
  double patience = 200e-6;  // s without work after which a worker goes to sleep, 0 to 1
};

/// A team for work of some microseconds: workers wait for it by spinning, and go to sleep where
/// none has come for a while, as between the ticks of a loop.
///
/// Runs are numbered. A share is done by whoever claims it first: its own worker, or, where that
/// still sleeps or has lost its processor, the calling thread once it has done its own share. So
/// the calling thread waits for shares that have begun only, and a machine with fewer processors
/// than members loses nothing but the gain. run() and call_up() neither allocate, lock nor throw;
/// both make a system call where there are sleepers to wake, and run() gives up its processor
/// where it has to wait for long.
class SpinTeam final : public math::Team {
 public:
  /// To be made before the loop takes an affinity, which workers would inherit. Throws
  /// std::invalid_argument for options out of range, std::system_error where the system has no
  /// thread left.
  explicit SpinTeam(const SpinTeamOptions& options);
  ~SpinTeam() override;
  SpinTeam(const SpinTeam&) = delete;
  SpinTeam& operator=(const SpinTeam&) = delete;

  int size() const noexcept override { return size_; }
  void run(math::TeamTask task) noexcept override;
  void call_up() noexcept override;

  /// What the system refused to the workers, a line each; empty where it granted all.
  const std::string& remarks() const noexcept { return remarks_; }

 private:
  using Number = std::uint32_t;  // of a run; wraps round
  /// A member's, on a cache line of its own.
  struct alignas(64) Post {
    std::atomic<Number> claimed{0};   // the last run whose share somebody took
    std::atomic<Number> finished{0};  // the last run whose share is done
  };

  static bool claim(Post& post, Number number) noexcept;
  void await(const Post& post, Number number) const noexcept;
  void ring() noexcept;
  void stop() noexcept;
  // Of workers.
  void work(int member) noexcept;
  bool wait_for_work(Number seen) noexcept;
  void sleep(Number seen, std::uint32_t heard) noexcept;

  int size_;
  std::int64_t patience_ns_;
  bool is_crowded_;  // fewer processors than members
  std::string remarks_;
  std::unique_ptr<Post[]> posts_;
  std::vector<std::thread> threads_;
  math::TeamTask task_;  // of the run under way

  alignas(64) std::atomic<Number> number_{0};  // of the last run
  std::atomic<bool> stop_{false};
  alignas(64) std::atomic<std::uint32_t> bell_{0};  // changes when sleepers shall wake
  std::atomic<int> sleepers_{0};
};

}  // namespace palpate::loop
