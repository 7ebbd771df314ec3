#include "rt/bus/telemetry_publisher.hpp"

#include <ctime>
#include <stdexcept>
#include <utility>

#include "rt/loop/real_time.hpp"

namespace palpate::bus {

TelemetryPublisher::TelemetryPublisher(Send send, int depth, int largest)
    : send_(std::move(send)), queue_(depth, largest) {
  if (sem_init(&wake_, 0, 0) != 0) throw std::runtime_error("the system has no semaphore left");
  thread_ = loop::start_helper_thread("palpate-publish", [this] { work(); });
}

TelemetryPublisher::~TelemetryPublisher() {
  stop_.store(true, std::memory_order_release);
  wake();
  thread_.join();
  sem_destroy(&wake_);
}

std::uint8_t* TelemetryPublisher::buffer(int size) noexcept {
  if (size <= queue_.largest()) return queue_.buffer();
  too_large_.fetch_add(1, std::memory_order_relaxed);
  return nullptr;
}

bool TelemetryPublisher::commit(const char* channel, int size) noexcept {
  if (!queue_.commit(channel, size)) return false;
  wake();
  return true;
}

/// Both sides use read-modify-write operations on one flag: either the thread finds the new message
/// in its last check before it sleeps, or this exchange finds it asleep.
void TelemetryPublisher::wake() noexcept {
  if (asleep_.exchange(false, std::memory_order_acq_rel)) sem_post(&wake_);
}

bool TelemetryPublisher::publish_queued() noexcept {
  bool any = false;
  while (const loop::TelemetryQueue::Record* record = queue_.take()) {
    any = true;
    if (!send_(record->channel, record->data.data(), record->size))
      failed_.fetch_add(1, std::memory_order_relaxed);
  }
  return any;
}

void TelemetryPublisher::work() noexcept {
  // Between cycles of the loop the thread polls at short intervals instead of waiting on a futex:
  // waking a thread costs the loop a system call and an inter-processor interrupt.
  constexpr timespec kNap{0, 1'000'000};
  constexpr int kNapsBeforeSleep = 2;
  int naps = 0;
  while (!stop_.load(std::memory_order_acquire)) {
    if (publish_queued()) {
      naps = 0;
    } else if (naps < kNapsBeforeSleep) {
      ++naps;
      nanosleep(&kNap, nullptr);
    } else {
      asleep_.exchange(true, std::memory_order_acq_rel);
      if (!publish_queued() && !stop_.load(std::memory_order_acquire)) sem_wait(&wake_);
      naps = 0;
    }
  }
  publish_queued();
}

}  // namespace palpate::bus
