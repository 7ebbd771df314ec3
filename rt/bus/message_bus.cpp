#include "rt/bus/message_bus.hpp"

#include <cstring>
#include <stdexcept>

#include "rt/loop/handover_ring.hpp"

namespace palpate::bus {
namespace {

constexpr int kFingerprintSize = 8;
constexpr int kSessionAt = kFingerprintSize + 8 + 4;  // after utime and seq

struct Slot {
  std::vector<std::uint8_t> data;
  std::int64_t arrival_ns = 0;
};

/// Number at `data`, in network order. Encoded messages begin with the fingerprint of their type.
std::int64_t number_at(const void* data) noexcept {
  std::uint64_t big_endian = 0;
  std::memcpy(&big_endian, data, sizeof(big_endian));
  return static_cast<std::int64_t>(__builtin_bswap64(big_endian));
}

void require_channel_name(const std::string& channel) {
  if (!is_channel_name(channel))
    throw std::invalid_argument("channel \"" + channel +
                                "\": a name is 1 to 63 of the characters A-Z, 0-9 and _");
}

Slot empty_slot(int encoded_size) {
  if (encoded_size < kFingerprintSize || encoded_size > kLargestEncodedSize)
    throw std::invalid_argument("encoded size must be 8 to " + std::to_string(kLargestEncodedSize) +
                                " bytes, not " + std::to_string(encoded_size));
  return {std::vector<std::uint8_t>(static_cast<std::size_t>(encoded_size)), 0};
}

void increment(std::atomic<std::int64_t>& counter) noexcept {
  counter.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace

bool is_channel_name(const std::string& name) noexcept {
  constexpr char kAllowed[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_";
  return !name.empty() && name.size() <= static_cast<std::size_t>(kLongestChannel) &&
         name.find_first_not_of(kAllowed) == std::string::npos;
}

std::string_view own_name(const ChannelNames& names, std::string_view name) noexcept {
  bool is_renamed = false;
  for (const auto& [own, on_bus] : names) {
    if (on_bus == name) return own;
    is_renamed = is_renamed || own == name;
  }
  return is_renamed ? std::string_view() : name;
}

bool fits_one_datagram(const char* channel, int size) noexcept {
  const auto name = static_cast<int>(strnlen(channel, kLongestChannel + 1));
  if (name == 0 || name > kLongestChannel) return false;
  return size >= 0 && size <= kLargestShortMessage - name - 1;
}

struct Subscription::Queue {
  loop::HandoverRing<Slot> ring;
};

Subscription::Subscription(std::string channel, int encoded_size, std::int64_t fingerprint,
                           int depth)
    : channel_(std::move(channel)), encoded_size_(encoded_size), fingerprint_(fingerprint) {
  require_channel_name(channel_);
  queue_.reset(new Queue{loop::HandoverRing<Slot>(depth, empty_slot(encoded_size))});
}

Subscription::~Subscription() = default;

void Subscription::offer(const void* data, int size, std::int64_t arrival_ns) noexcept {
  if (size < kFingerprintSize) return increment(counters_.wrong_size);
  // The type is checked first: another version of a type usually differs in size as well, and the
  // type is the more useful diagnosis.
  if (const std::int64_t fingerprint = number_at(data); fingerprint != fingerprint_) {
    counters_.last_wrong_fingerprint.store(fingerprint, std::memory_order_relaxed);
    return increment(counters_.wrong_type);
  }
  if (size != encoded_size_) return increment(counters_.wrong_size);
  if (!is_followed(data, arrival_ns)) return increment(counters_.other_sender);
  Slot& slot = queue_->ring.back();
  std::memcpy(slot.data.data(), data, static_cast<std::size_t>(size));
  slot.arrival_ns = arrival_ns;
  if (queue_->ring.publish()) increment(counters_.dropped);
  increment(counters_.received);
}

bool Subscription::is_followed(const void* data, std::int64_t arrival_ns) noexcept {
  if (silence_ns_ < 0 || encoded_size_ < kSessionAt + 8) return true;
  const std::int64_t session = number_at(static_cast<const std::uint8_t*>(data) + kSessionAt);
  if (followed_.any && session != followed_.session) {
    constexpr int kPatience = 5;
    const bool goes_on = before_.any && session == before_.session &&
                         arrival_ns - before_.received_ns < kPatience * silence_ns_;
    const bool is_silent = arrival_ns - followed_.received_ns >= silence_ns_;
    if (!goes_on && !is_silent) return false;
    before_ = goes_on ? Sender() : followed_;
  }
  followed_ = {session, arrival_ns, true};
  return true;
}

const void* Subscription::take(std::int64_t& arrival_ns) noexcept {
  const Slot* slot = queue_->ring.take();
  if (slot == nullptr) return nullptr;
  arrival_ns = slot->arrival_ns;
  return slot->data.data();
}

}  // namespace palpate::bus
