#include "rt/loop/spin_team.hpp"

#include <linux/futex.h>
#include <sched.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <climits>
#include <ctime>
#include <future>
#include <stdexcept>
#include <utility>

#include "rt/loop/fixed_rate_loop.hpp"
#include "rt/loop/real_time.hpp"

namespace palpate::loop {
namespace {

constexpr int kLargestSize = 64;
constexpr int kSpinsPerLook = 32;  // between two readings of the clock
// Waiting strategy of the calling thread for a share that has begun: it pauses for about 100
// microseconds, then yields to threads of its priority, then to all others, because the worker may
// need this processor.
constexpr int kPauses = 4000;
constexpr int kYields = 200;
constexpr timespec kNap{0, 20'000};

void pause() noexcept {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

void futex(std::atomic<std::uint32_t>& word, int operation, std::uint32_t value) noexcept {
  static_assert(sizeof(word) == sizeof(std::uint32_t));
  syscall(SYS_futex, reinterpret_cast<std::uint32_t*>(&word), operation | FUTEX_PRIVATE_FLAG, value,
          nullptr, nullptr, 0);
}

bool has_fewer_processors_than(int size) {
  cpu_set_t set;
  CPU_ZERO(&set);
  return sched_getaffinity(0, sizeof(set), &set) == 0 && CPU_COUNT(&set) < size;
}

/// Sets affinity and priority of the calling thread; returns rejected settings, a line each.
std::string take_place(int cpu, int fifo_priority) {
  std::string refusals;
  const auto note = [&refusals](const std::string& refusal) {
    if (!refusal.empty()) refusals += (refusals.empty() ? "" : "\n") + refusal;
  };
  if (cpu >= 0) note(take_cpu(cpu));
  if (fifo_priority > 0) note(take_fifo(fifo_priority));
  return refusals;
}

}  // namespace

SpinTeam::SpinTeam(const SpinTeamOptions& options)
    : size_(options.size),
      patience_ns_(static_cast<std::int64_t>(options.patience * 1e9)),
      is_crowded_(has_fewer_processors_than(options.size)) {
  if (options.size < 1 || options.size > kLargestSize) {
    throw std::invalid_argument("a team has 1 to 64 members, not " + std::to_string(options.size));
  }
  if (!(options.patience >= 0 && options.patience <= 1)) {
    throw std::invalid_argument("a team's patience is 0 to 1 s, not " +
                                std::to_string(options.patience));
  }
  posts_ = std::make_unique<Post[]>(static_cast<std::size_t>(size_));
  std::vector<std::future<std::string>> refusals;
  try {
    for (int member = 1; member < size_; ++member) {
      const auto k = static_cast<std::size_t>(member - 1);
      const int cpu = k < options.cpus.size() ? options.cpus[k] : -1;
      std::promise<std::string> placed;
      refusals.push_back(placed.get_future());
      threads_.push_back(
          start_helper_thread("palpate-team", [this, member, cpu, priority = options.fifo_priority,
                                               placed = std::move(placed)]() mutable {
            placed.set_value(take_place(cpu, priority));
            work(member);
          }));
    }
    for (auto& refusal : refusals) {
      const std::string text = refusal.get();
      if (!text.empty()) remarks_ += (remarks_.empty() ? "" : "\n") + text;
    }
  } catch (...) {
    stop();
    throw;
  }
}

SpinTeam::~SpinTeam() { stop(); }

void SpinTeam::stop() noexcept {
  stop_.store(true);
  ring();
  for (std::thread& thread : threads_) thread.join();
}

bool SpinTeam::claim(Post& post, Number number) noexcept {
  Number last = number - 1;
  return post.claimed.compare_exchange_strong(last, number, std::memory_order_acq_rel,
                                              std::memory_order_relaxed);
}

// Between two runs all shares are claimed and finished, so that no thread reads task_ while it
// changes: a late worker finds its share claimed.
void SpinTeam::run(math::TeamTask task) noexcept {
  task_ = task;
  const Number number = number_.load(std::memory_order_relaxed) + 1;
  // Either this thread sees the sleeping worker or that worker sees the number: both accesses are
  // sequentially consistent.
  number_.store(number);
  if (sleepers_.load() > 0) ring();
  task(0, size_);
  for (int member = 1; member < size_; ++member) {
    Post& post = posts_[member];
    if (!claim(post, number)) continue;
    task(member, size_);
    post.finished.store(number, std::memory_order_relaxed);
  }
  for (int member = 1; member < size_; ++member) await(posts_[member], number);
}

void SpinTeam::await(const Post& post, Number number) const noexcept {
  const int pauses = is_crowded_ ? 0 : kPauses;
  for (int k = 0; post.finished.load(std::memory_order_acquire) != number; ++k) {
    if (k < pauses) {
      pause();
    } else if (k < pauses + kYields) {
      sched_yield();
    } else {
      clock_nanosleep(CLOCK_MONOTONIC, 0, &kNap, nullptr);
      k = pauses + kYields;
    }
  }
}

void SpinTeam::call_up() noexcept {
  if (size_ > 1) ring();
}

void SpinTeam::ring() noexcept {
  bell_.fetch_add(1);
  if (sleepers_.load() > 0) futex(bell_, FUTEX_WAKE, INT_MAX);
}

void SpinTeam::work(int member) noexcept {
  Post& post = posts_[member];
  Number seen = 0;
  while (wait_for_work(seen)) {
    seen = number_.load(std::memory_order_acquire);
    if (!claim(post, seen)) continue;
    task_(member, size_);
    post.finished.store(seen, std::memory_order_release);
  }
}

/// True after a run later than number `seen`, false at shutdown.
bool SpinTeam::wait_for_work(Number seen) noexcept {
  std::uint32_t heard = bell_.load();
  std::int64_t end = monotonic_ns() + patience_ns_;
  while (!stop_.load(std::memory_order_relaxed)) {
    for (int k = 0; k < kSpinsPerLook; ++k) {
      if (number_.load(std::memory_order_acquire) != seen) return true;
      is_crowded_ ? void(sched_yield()) : pause();
    }
    if (monotonic_ns() > end) {
      sleep(seen, heard);
    } else if (bell_.load(std::memory_order_relaxed) == heard) {
      continue;
    }
    heard = bell_.load();
    end = monotonic_ns() + patience_ns_;
  }
  return false;
}

void SpinTeam::sleep(Number seen, std::uint32_t heard) noexcept {
  sleepers_.fetch_add(1);
  if (number_.load() == seen && !stop_.load()) futex(bell_, FUTEX_WAIT, heard);
  sleepers_.fetch_sub(1);
}

}  // namespace palpate::loop
