#include "rt/bus/fragments.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace palpate::bus {
namespace {

constexpr char kMagic[] = {'L', 'C', '0', '3'};
constexpr int kHeaderSize = 20;

std::uint32_t word_at(const std::uint8_t* data) noexcept {
  std::uint32_t big_endian = 0;
  std::memcpy(&big_endian, data, sizeof(big_endian));
  return __builtin_bswap32(big_endian);
}

int half_word_at(const std::uint8_t* data) noexcept { return data[0] << 8 | data[1]; }

}  // namespace

FragmentAssembler::FragmentAssembler(int largest) : largest_(static_cast<std::uint32_t>(largest)) {
  if (largest < 1) throw std::invalid_argument("largest message: at least 1 byte");
  for (Message& message : messages_) {
    message.part = std::make_unique<Part[]>(kMostParts);
    // not initialised, so that the system provides memory for what arrives only
    message.payload.reset(new std::uint8_t[largest_]);
  }
}

bool FragmentAssembler::is_fragment(const std::uint8_t* data, int size) noexcept {
  return size >= static_cast<int>(sizeof(kMagic)) && std::memcmp(data, kMagic, sizeof(kMagic)) == 0;
}

int FragmentAssembler::give_up(Message& message) noexcept {
  const int received = message.parts - message.missing;
  message.parts = message.missing = 0;
  return received;
}

FragmentAssembler::Message& FragmentAssembler::message_of(std::uint64_t sender,
                                                          std::uint32_t sequence,
                                                          std::uint32_t size, int parts,
                                                          std::int64_t arrival_ns,
                                                          std::int64_t& dropped) noexcept {
  Message* found = nullptr;
  for (Message& message : messages_) {
    if (message.parts > 0 && arrival_ns - message.began_ns > kLongest) dropped += give_up(message);
    if (message.parts == parts && message.sender == sender && message.sequence == sequence &&
        message.size == size)
      found = &message;
  }
  if (found != nullptr) return *found;

  const auto is_better = [](const Message& one, const Message& other) {
    if ((one.parts == 0) != (other.parts == 0)) return one.parts == 0;
    return one.began_ns < other.began_ns;
  };
  Message& message = *std::min_element(messages_.begin(), messages_.end(), is_better);
  dropped += give_up(message);
  message.sender = sender;
  message.sequence = sequence;
  message.size = size;
  message.parts = message.missing = parts;
  message.began_ns = arrival_ns;
  std::fill_n(message.part.get(), parts, Part());
  return message;
}

/// Whether the parts follow one another without gap or overlap.
bool FragmentAssembler::is_contiguous(const Message& message) noexcept {
  std::uint32_t end = 0;
  for (int i = 0; i < message.parts; ++i) {
    if (message.part[i].at != end) return false;
    end += message.part[i].size;
  }
  return end == message.size;
}

FragmentAssembler::Message* FragmentAssembler::joined(const std::uint8_t* data, int size,
                                                      std::uint64_t sender, std::int64_t arrival_ns,
                                                      std::int64_t& dropped) noexcept {
  dropped = 1;  // this part, unless it has a place
  if (!is_fragment(data, size) || size < kHeaderSize) return nullptr;
  const std::uint32_t whole = word_at(data + 8), at = word_at(data + 12);
  const int number = half_word_at(data + 16), parts = half_word_at(data + 18);
  if (whole == 0 || whole > largest_ || parts < 1 || parts > kMostParts || number >= parts)
    return nullptr;

  const std::uint8_t* part = data + kHeaderSize;
  auto part_size = static_cast<std::uint32_t>(size - kHeaderSize);
  std::size_t name_size = 0;
  if (number == 0) {
    const auto searched = std::min<std::size_t>(part_size, kLongestChannel + 1);
    const void* zero = std::memchr(part, 0, searched);
    if (zero == nullptr || zero == part) return nullptr;
    name_size = static_cast<std::size_t>(static_cast<const std::uint8_t*>(zero) - part) + 1;
    part_size -= static_cast<std::uint32_t>(name_size);
  }
  if (at > whole || part_size > whole - at) return nullptr;

  Message& message = message_of(sender, word_at(data + 4), whole, parts, arrival_ns, dropped);
  Part& place = message.part[number];
  if (place.is_there) return nullptr;
  --dropped;
  place = {at, part_size, true};
  if (name_size > 0) std::memcpy(message.channel.data(), part, name_size);
  std::memcpy(message.payload.get() + at, part + name_size, part_size);
  if (--message.missing > 0) return nullptr;
  const bool is_sound = is_contiguous(message);
  const int received = give_up(message);  // the memory is free for the next one
  if (!is_sound) dropped += received;
  return is_sound ? &message : nullptr;
}

bool FragmentAssembler::take(const std::uint8_t* data, int size, std::uint64_t sender,
                             std::int64_t arrival_ns, DatagramCounters& counters,
                             UdpmFrame& frame) noexcept {
  std::int64_t dropped = 0;
  const Message* message = joined(data, size, sender, arrival_ns, dropped);
  counters.received.fetch_add(1, std::memory_order_relaxed);
  counters.fragmented.fetch_add(dropped, std::memory_order_relaxed);
  if (message == nullptr) return false;
  frame = {message->channel.data(), message->payload.get(), static_cast<int>(message->size)};
  return true;
}

}  // namespace palpate::bus
