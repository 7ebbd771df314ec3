#pragma once

#include <algorithm>
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

inline void append(std::vector<std::uint8_t>& to, std::uint64_t number, int bytes) {
  for (int i = bytes - 1; i >= 0; --i) to.push_back(static_cast<std::uint8_t>(number >> 8 * i));
}

/// LCM's datagram of part `number` of `parts` of a message of `whole` bytes, from the byte `at` on.
inline std::vector<std::uint8_t> fragment(std::uint32_t sequence, std::uint32_t whole,
                                          std::uint32_t at, int number, int parts,
                                          const std::string& channel,
                                          const std::vector<std::uint8_t>& part) {
  std::vector<std::uint8_t> data{'L', 'C', '0', '3'};
  append(data, sequence, 4);
  append(data, whole, 4);
  append(data, at, 4);
  append(data, static_cast<std::uint64_t>(number), 2);
  append(data, static_cast<std::uint64_t>(parts), 2);
  if (number == 0) data.insert(data.end(), channel.c_str(), channel.c_str() + channel.size() + 1);
  data.insert(data.end(), part.begin(), part.end());
  data.shrink_to_fit();
  return data;
}

/// A message in parts of at most `part` bytes.
inline std::vector<std::vector<std::uint8_t>> in_parts(const std::string& channel,
                                                       std::uint32_t sequence,
                                                       const std::vector<std::uint8_t>& payload,
                                                       int part) {
  const int size = static_cast<int>(payload.size()), parts = (size + part - 1) / part;
  std::vector<std::vector<std::uint8_t>> datagrams;
  for (int i = 0; i < parts; ++i) {
    const auto begin = payload.begin() + i * part;
    datagrams.push_back(fragment(sequence, static_cast<std::uint32_t>(size),
                                 static_cast<std::uint32_t>(i * part), i, parts, channel,
                                 {begin, begin + std::min(part, size - i * part)}));
  }
  return datagrams;
}

/// Copies the oldest message of a subscription, if there is one.
inline bool take(Subscription& subscription, void* buffer, std::int64_t& arrival_ns) {
  const void* data = subscription.take(arrival_ns);
  if (data != nullptr)
    std::memcpy(buffer, data, static_cast<std::size_t>(subscription.encoded_size()));
  return data != nullptr;
}

}  // namespace palpate::bus::wire
