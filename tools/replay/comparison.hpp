#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "core/math/fnv1a.hpp"

namespace palpate::replay {

/// Messages of the daemon on one channel, recorded in the log and in the replay.
struct ChannelComparison {
  std::int64_t recorded = 0, replayed = 0;  // times of messages
  std::int64_t common = 0;                  // of them in both
  std::int64_t equal = 0;                   // of these, bit-identical
  std::int64_t first_difference = -1;       // utime, us; negative: none
};

/// Compares the daemon's recorded messages with those of a replay of the same log, message by
/// message of the same utime, except for fields that are regenerated at each start: number,
/// session, counter and authentication.
class Comparison {
 public:
  /// Channels that are compared: those determined by the inputs alone.
  static bool concerns(const std::string& channel);

  void take_recorded(const std::string& channel, const std::uint8_t* data, int size);
  void take_replayed(const std::string& channel, const std::uint8_t* data, int size);

  /// By channel, those that were in either.
  std::map<std::string, ChannelComparison> result() const;

 private:
  using Hashes = std::map<std::int64_t, math::Fnv1a>;  // by utime
  static void take(Hashes& hashes, const std::string& channel, const std::uint8_t* data, int size);

  std::map<std::string, Hashes> recorded_, replayed_;
};

}  // namespace palpate::replay
