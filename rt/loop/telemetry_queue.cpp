#include "rt/loop/telemetry_queue.hpp"

#include <cstring>
#include <stdexcept>
#include <string>

namespace palpate::loop {
namespace {

TelemetryQueue::Record empty_record(int largest) {
  if (largest < 1)
    throw std::invalid_argument("largest record must be positive, not " + std::to_string(largest));
  return {{}, 0, std::vector<std::uint8_t>(static_cast<std::size_t>(largest))};
}

}  // namespace

TelemetryQueue::TelemetryQueue(int depth, int largest)
    : largest_(largest), ring_(depth, empty_record(largest)) {}

bool TelemetryQueue::commit(std::string_view channel, int size) noexcept {
  if (size < 0 || size > largest_ || channel.empty() || channel.size() > kLongestChannel) {
    rejected_.fetch_add(1, std::memory_order_relaxed);
    return false;
  }
  Record& record = ring_.back();
  std::memcpy(record.channel, channel.data(), channel.size());
  record.channel[channel.size()] = '\0';
  record.size = size;
  if (ring_.publish()) dropped_.fetch_add(1, std::memory_order_relaxed);
  return true;
}

}  // namespace palpate::loop
