#pragma once

#include <pthread.h>
#include <sched.h>
#include <csignal>
#include <string>
#include <thread>
#include <utility>

namespace palpate::loop {

/// Individual steps of FixedRateLoop::acquire_real_time(). Each returns an empty text if the system
/// granted it, otherwise one line: the rejected setting, reason, and remedy.

/// Prevents the heap from being returned to the system, prefaults the heap and this thread's stack,
/// and locks all present and future memory of the process.
std::string lock_and_prefault_memory();

/// Whether lock_and_prefault_memory() has locked this process; a page fault is then an error.
bool memory_is_locked() noexcept;

/// Sets SCHED_FIFO for the calling thread; threads that it starts later do not inherit it.
std::string take_fifo(int priority);

/// Binds the calling thread to one processor.
std::string take_cpu(int cpu);

/// Starts a non-real-time thread: named (at most 15 characters), scheduled as SCHED_OTHER
/// regardless of its creator, and with all signals blocked, so that SIGTERM and similar signals
/// reach the main thread. Throws std::system_error if no thread can be created.
template <class F>
std::thread start_helper_thread(const char* name, F&& body) {
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  struct Restore {
    const sigset_t& mask;
    ~Restore() { pthread_sigmask(SIG_SETMASK, &mask, nullptr); }
  } restore{before};
  return std::thread([name, body = std::forward<F>(body)]() mutable {
    const sched_param parameters{};
    pthread_setschedparam(pthread_self(), SCHED_OTHER, &parameters);
    pthread_setname_np(pthread_self(), name);
    body();
  });
}

}  // namespace palpate::loop
