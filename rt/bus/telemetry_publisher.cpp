#include "rt/bus/telemetry_publisher.hpp"

#include <cerrno>
#include <stdexcept>

#include "rt/loop/helper_thread.hpp"

namespace palpate::bus {

TelemetryPublisher::TelemetryPublisher(MessageBus& bus, int depth, int largest)
    : bus_(bus), queue_(depth, largest) {
  if (sem_init(&wake_, 0, 0) != 0) throw std::runtime_error("the system has no semaphore left");
  thread_ = loop::start_helper_thread("palpate-publish", [this] { work(); });
}

TelemetryPublisher::~TelemetryPublisher() {
  stop_.store(true, std::memory_order_release);
  sem_post(&wake_);
  thread_.join();
  sem_destroy(&wake_);
}

void TelemetryPublisher::work() noexcept {
  bool last = false;
  while (!last) {
    while (sem_wait(&wake_) != 0 && errno == EINTR) {
    }
    last = stop_.load(std::memory_order_acquire);
    while (const loop::TelemetryQueue::Record* record = queue_.take())
      if (!bus_.publish(record->channel, record->data.data(), record->size))
        failed_.fetch_add(1, std::memory_order_relaxed);
  }
}

}  // namespace palpate::bus
