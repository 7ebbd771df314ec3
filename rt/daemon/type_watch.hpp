#pragma once

#include <array>
#include <cstdint>

#include "rt/bus/message_bus.hpp"

namespace palpate::daemon {

/// Detects messages of a different type, or a different version of it, on the channels of a bus.
/// Each channel is reported at once and then at most once per second.
class TypeWatch {
 public:
  explicit TypeWatch(const bus::MessageBus& bus) : bus_(bus) {}

  /// Next channel to report; nullptr if there is none. `now_ns`: clock of the arrival times.
  const bus::Subscription* look(std::int64_t now_ns) noexcept {
    const auto& channels = bus_.subscriptions();
    for (std::size_t i = 0; i < channels.size() && i < told_.size(); ++i) {
      const std::int64_t count = channels[i]->counters().wrong_type.load(std::memory_order_relaxed);
      Told& told = told_[i];
      if (count == told.count || (told.count > 0 && now_ns - told.at_ns < kInterval)) continue;
      told = {count, now_ns};
      return channels[i];
    }
    return nullptr;
  }

 private:
  static constexpr std::int64_t kInterval = 1'000'000'000;
  struct Told {
    std::int64_t count = 0;
    std::int64_t at_ns = 0;
  };
  const bus::MessageBus& bus_;
  std::array<Told, 32> told_{};
};

}  // namespace palpate::daemon
