#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "rt/bus/message_bus.hpp"

namespace palpate::bus::wire {

/// The encoded form of `message`.
template <class Message>
std::vector<std::uint8_t> encoded(const Message& message) {
  std::vector<std::uint8_t> data(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(data.data(), 0, static_cast<int>(data.size()));
  return data;
}

/// LCM's datagram of a short message, written from the protocol's specification.
inline std::vector<std::uint8_t> datagram(const std::string& channel,
                                          const std::vector<std::uint8_t>& payload,
                                          const std::string& magic = "LC02") {
  std::vector<std::uint8_t> data(magic.begin(), magic.end());
  data.insert(data.end(), {0, 0, 0, 1});
  data.insert(data.end(), channel.begin(), channel.end());
  data.push_back(0);
  data.insert(data.end(), payload.begin(), payload.end());
  data.shrink_to_fit();  // so that the address sanitizer detects a read beyond the end
  return data;
}

/// Copies the oldest message of a subscription, if there is one.
inline bool take(Subscription& subscription, void* buffer, std::int64_t& arrival_ns) {
  const void* data = subscription.take(arrival_ns);
  if (data != nullptr)
    std::memcpy(buffer, data, static_cast<std::size_t>(subscription.encoded_size()));
  return data != nullptr;
}

}  // namespace palpate::bus::wire
