#include "tools/replay/comparison.hpp"

#include <array>
#include <cstring>

namespace palpate::replay {
namespace {

// Header of an encoded message: fingerprint, utime, seq, session; for a command also counter and
// code.
constexpr int kUtimeAt = 8, kSeqAt = 16, kHeaderEnd = 28, kCommandHeaderEnd = 28 + 8 + 32;

constexpr std::array<const char*, 4> kStates = {"CONTACTS", "ESTIMATE", "FEATURE", "SHAPE"};
constexpr std::array<const char*, 3> kCommands = {"TWIST_COMMAND", "JOINT_VELOCITY_COMMAND",
                                                  "HAND_COMMAND"};

/// Without the suffix of a second arm.
std::string plain(const std::string& channel) {
  const std::size_t size = channel.size();
  return size > 2 && channel.compare(size - 2, 2, "_1") == 0 ? channel.substr(0, size - 2)
                                                             : channel;
}

template <std::size_t kSize>
bool is_one(const std::string& channel, const std::array<const char*, kSize>& names) {
  for (const char* name : names) {
    if (channel == name) return true;
  }
  return false;
}

std::int64_t utime_of(const std::uint8_t* data) {
  std::uint64_t big_endian = 0;
  std::memcpy(&big_endian, data + kUtimeAt, sizeof(big_endian));
  return static_cast<std::int64_t>(__builtin_bswap64(big_endian));
}

}  // namespace

bool Comparison::concerns(const std::string& channel) {
  return is_one(plain(channel), kStates) || is_one(plain(channel), kCommands);
}

void Comparison::take(Hashes& hashes, const std::string& channel, const std::uint8_t* data,
                      int size) {
  const int skipped_to = is_one(plain(channel), kCommands) ? kCommandHeaderEnd : kHeaderEnd;
  if (size < skipped_to) return;
  math::Fnv1a& hash = hashes[utime_of(data)];
  hash.add(data, kSeqAt);
  hash.add(data + skipped_to, static_cast<std::size_t>(size - skipped_to));
}

void Comparison::take_recorded(const std::string& channel, const std::uint8_t* data, int size) {
  if (concerns(channel)) take(recorded_[channel], channel, data, size);
}

void Comparison::take_replayed(const std::string& channel, const std::uint8_t* data, int size) {
  if (concerns(channel)) take(replayed_[channel], channel, data, size);
}

std::map<std::string, ChannelComparison> Comparison::result() const {
  std::map<std::string, ChannelComparison> result;
  for (const auto& [channel, hashes] : replayed_)
    result[channel].replayed = static_cast<std::int64_t>(hashes.size());
  for (const auto& [channel, hashes] : recorded_) {
    ChannelComparison& one = result[channel];
    one.recorded = static_cast<std::int64_t>(hashes.size());
    const auto replayed = replayed_.find(channel);
    if (replayed == replayed_.end()) continue;
    for (const auto& [utime, hash] : hashes) {
      const auto same = replayed->second.find(utime);
      if (same == replayed->second.end()) continue;
      ++one.common;
      if (same->second.value() == hash.value()) {
        ++one.equal;
      } else if (one.first_difference < 0) {
        one.first_difference = utime;
      }
    }
  }
  return result;
}

}  // namespace palpate::replay
