#include "rt/bus/telemetry_publisher.hpp"

#include <cstring>
#include <ctime>
#include <stdexcept>
#include <string>
#include <utility>

#include "rt/loop/real_time.hpp"

namespace palpate::bus {

TelemetryPublisher::Record TelemetryPublisher::empty_record(int largest) {
  if (largest < 1)
    throw std::invalid_argument("largest message must be positive, not " + std::to_string(largest));
  return {{}, 0, std::vector<std::uint8_t>(static_cast<std::size_t>(largest))};
}

TelemetryPublisher::TelemetryPublisher(Send send, int depth, int largest)
    : send_(std::move(send)), largest_(largest), queue_(depth, empty_record(largest)) {
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
  if (size <= largest_) return queue_.back().data.data();
  lose_one();
  return nullptr;
}

bool TelemetryPublisher::commit(const char* channel, int size) noexcept {
  const std::size_t name = strnlen(channel, kLongestChannel + 1);
  if (size < 0 || size > largest_ || name == 0 || name > kLongestChannel) {
    lose_one();
    return false;
  }
  Record& record = queue_.back();
  std::memcpy(record.channel, channel, name + 1);
  record.size = size;
  if (queue_.publish()) lose_one();
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
  while (const Record* record = queue_.take()) {
    any = true;
    if (!send_(record->channel, record->data.data(), record->size)) lose_one();
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
