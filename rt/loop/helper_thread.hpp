#pragma once

#include <pthread.h>
#include <sched.h>

#include <csignal>
#include <thread>
#include <utility>

namespace palpate::loop {

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
