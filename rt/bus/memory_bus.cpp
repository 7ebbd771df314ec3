#include <algorithm>
#include <thread>

#include "rt/bus/message_bus.hpp"
#include "rt/loop/allocation_counter.hpp"

namespace palpate::bus {
namespace {

class MemoryBus;

}  // namespace

class MemoryHub {
 public:
  void attach(MemoryBus* bus) { buses_.push_back(bus); }
  void detach(MemoryBus* bus) noexcept {
    buses_.erase(std::remove(buses_.begin(), buses_.end(), bus), buses_.end());
  }
  void publish(const char* channel, const void* data, int size) noexcept;

  std::int64_t now_ns = 0;
  std::vector<Published>* recording = nullptr;

 private:
  std::vector<MemoryBus*> buses_;
};

namespace {

class MemoryBus final : public MessageBus {
 public:
  explicit MemoryBus(std::shared_ptr<MemoryHub> hub) : hub_(std::move(hub)) { hub_->attach(this); }
  ~MemoryBus() override { hub_->detach(this); }
  MemoryBus(const MemoryBus&) = delete;
  MemoryBus& operator=(const MemoryBus&) = delete;

  Subscription& subscribe(const std::string& channel, int encoded_size, std::int64_t fingerprint,
                          int depth) override {
    subscriptions_.push_back(
        std::make_unique<Subscription>(channel, encoded_size, fingerprint, depth));
    return listed(*subscriptions_.back());
  }
  void start() override {}
  void start_without_thread() override {}
  bool receive(std::int64_t) noexcept override {
    std::this_thread::yield();
    return false;
  }
  void stop() noexcept override {}
  bool publish(const char* channel, const void* data, int size) noexcept override {
    if (!fits_one_datagram(channel, size)) return false;
    hub_->publish(channel, data, size);
    return true;
  }

  void offer(const char* channel, const void* data, int size, std::int64_t now_ns) noexcept {
    for (const auto& subscription : subscriptions_)
      if (subscription->channel() == channel) subscription->offer(data, size, now_ns);
  }

 private:
  std::shared_ptr<MemoryHub> hub_;
  std::vector<std::unique_ptr<Subscription>> subscriptions_;
};

}  // namespace

void MemoryHub::publish(const char* channel, const void* data, int size) noexcept {
  for (MemoryBus* bus : buses_) bus->offer(channel, data, size, now_ns);
  if (recording == nullptr) return;
  const loop::WatcherScope watcher;
  const auto* bytes = static_cast<const std::uint8_t*>(data);
  recording->push_back({channel, {bytes, bytes + size}, now_ns});
}

std::shared_ptr<MemoryHub> make_memory_hub() { return std::make_shared<MemoryHub>(); }

std::unique_ptr<MessageBus> make_memory_bus(std::shared_ptr<MemoryHub> hub) {
  return std::make_unique<MemoryBus>(std::move(hub));
}

void set_time(MemoryHub& hub, std::int64_t now_ns) noexcept { hub.now_ns = now_ns; }

void record(MemoryHub& hub, std::vector<Published>* into) noexcept { hub.recording = into; }

}  // namespace palpate::bus
