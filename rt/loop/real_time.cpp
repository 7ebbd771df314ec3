#include "rt/loop/real_time.hpp"

#include <linux/capability.h>
#include <malloc.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "rt/loop/sanitizer.hpp"

namespace palpate::loop {
namespace {

constexpr std::size_t kPrefaultedHeap = 16u << 20;
constexpr std::size_t kPrefaultedStack = 256u << 10;

std::atomic<bool> locked{false};

std::string why(int error) { return std::strerror(error); }

bool may_lock_without_limit() {
  rlimit limit{};
  if (getrlimit(RLIMIT_MEMLOCK, &limit) == 0 && limit.rlim_cur == RLIM_INFINITY) return true;
  __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
  __user_cap_data_struct data[2]{};
  if (syscall(SYS_capget, &header, data) != 0) return false;
  return (data[0].effective & (1u << CAP_IPC_LOCK)) != 0;
}

void touch(volatile char* begin, std::size_t size) {
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  for (std::size_t i = 0; i < size; i += page) begin[i] = 1;
}

__attribute__((noinline)) void prefault_stack() {
  volatile char stack[kPrefaultedStack];
  touch(stack, sizeof(stack));
}

void prefault_heap() {
  void* heap = std::malloc(kPrefaultedHeap);
  if (heap == nullptr) return;
  touch(static_cast<volatile char*>(heap), kPrefaultedHeap);
  std::free(heap);
}

}  // namespace

std::string lock_and_prefault_memory() {
  if (kSanitized)
    return "memory is not locked: a sanitizer's shadow memory is larger than any machine";
  // Freed memory remains with the process, so that later set-up code causes no page faults.
  mallopt(M_TRIM_THRESHOLD, -1);
  mallopt(M_MMAP_MAX, 0);
  std::string refusal;
  // With a finite limit, locking future memory would make a later allocation fail instead.
  if (!may_lock_without_limit())
    refusal =
        "memory is not locked: the limit is finite; raise it with LimitMEMLOCK=infinity (systemd), "
        "`memlock unlimited` (limits.conf) or CAP_IPC_LOCK";
  else if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0)
    refusal = "memory is not locked: mlockall: " + why(errno);
  prefault_heap();
  prefault_stack();
  locked.store(refusal.empty(), std::memory_order_relaxed);
  return refusal;
}

bool memory_is_locked() noexcept { return locked.load(std::memory_order_relaxed); }

std::string take_fifo(int priority) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  if (sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &parameters) == 0) return {};
  const int error = errno;
  return "no SCHED_FIFO priority " + std::to_string(priority) + ": " + why(error) +
         "; allow it with LimitRTPRIO=" + std::to_string(priority) +
         " (systemd), `rtprio` (limits.conf) or CAP_SYS_NICE";
}

std::string take_cpu(int cpu) {
  if (cpu < 0 || cpu >= CPU_SETSIZE) return "no processor has the number " + std::to_string(cpu);
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(static_cast<unsigned>(cpu), &set);
  if (sched_setaffinity(0, sizeof(set), &set) == 0) return {};
  const int error = errno;
  return "not bound to processor " + std::to_string(cpu) + ": " + why(error) +
         "; choose one of the processors that `nproc` and CPUAffinity= leave to this process";
}

}  // namespace palpate::loop
