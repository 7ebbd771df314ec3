#include "rt/loop/background_worker.hpp"

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <stdexcept>

#include "rt/loop/real_time.hpp"

namespace palpate::loop {
namespace {

// after the receiver and publisher threads, before user processes run with `nice`
constexpr int kNice = 5;

}  // namespace

BackgroundWorker::BackgroundWorker() {
  if (sem_init(&wake_, 0, 0) != 0 || sem_init(&ended_, 0, 0) != 0)
    throw std::runtime_error("the system has no semaphore left");
  try {
    thread_ = start_helper_thread("palpate-worker", [this] { work(); });
  } catch (...) {
    sem_destroy(&wake_);
    sem_destroy(&ended_);
    throw;
  }
}

BackgroundWorker::~BackgroundWorker() {
  stop_.store(true, std::memory_order_release);
  sem_post(&wake_);
  thread_.join();
  sem_destroy(&wake_);
  sem_destroy(&ended_);
}

bool BackgroundWorker::submit(Job job, void* argument) noexcept {
  if (state_.load(std::memory_order_acquire) != kIdle) return false;
  job_ = job;
  argument_ = argument;
  state_.store(kRunning, std::memory_order_release);
  sem_post(&wake_);
  return true;
}

void* BackgroundWorker::finished() noexcept {
  if (state_.load(std::memory_order_acquire) != kFinished) return nullptr;
  sem_trywait(&ended_);  // if the post arrives only after this call, wait() handles it
  void* argument = argument_;
  state_.store(kIdle, std::memory_order_release);
  return argument;
}

void* BackgroundWorker::wait() noexcept {
  while (state_.load(std::memory_order_acquire) == kRunning) sem_wait(&ended_);
  return finished();
}

bool BackgroundWorker::busy() const noexcept {
  return state_.load(std::memory_order_acquire) != kIdle;
}

void BackgroundWorker::work() noexcept {
  setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), kNice);
  for (;;) {
    while (sem_wait(&wake_) != 0 && errno == EINTR) {
    }
    if (stop_.load(std::memory_order_acquire)) return;
    job_(argument_);
    state_.store(kFinished, std::memory_order_release);
    sem_post(&ended_);
  }
}

}  // namespace palpate::loop
