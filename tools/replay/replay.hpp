#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/math/fnv1a.hpp"
#include "rt/bus/message_bus.hpp"
#include "rt/daemon/daemon.hpp"

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
/// session, counter and authentication. Recorded messages of former types are left out.
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

struct ReplayOptions {
  std::string log;     // recorded on the control URL
  std::string output;  // log of everything that the daemon publishes; empty: none
  bool start = false;  // send the event start before the first message
  // One cycle for each SIM_TICK of the log, as palpated --stepped ran it, instead of the log's
  // time.
  bool stepped = false;
  bool compare = false;      // with the daemon's messages recorded in the log
  std::string housekeeping;  // log of the housekeeping URL, for SHAPE to compare; empty: none
};

struct ReplayResult {
  std::int64_t cycles = 0;
  std::int64_t messages = 0;  // read from the log and passed to the daemon
  std::int64_t left_out = 0;  // of channels that the daemon does not receive
  std::int64_t starts = 0;    // of them, commands with the event start
  std::int64_t shapes = 0;
  std::uint64_t shape_hash = 0;  // FNV-1a over every published SHAPE, byte by byte
  double duration = 0;           // s of the log
  std::map<std::string, ChannelComparison> comparison;  // by channel, if requested
  std::string complaint;  // damaged parts of the log, in one line; usually empty
};

/// Runs a daemon over a log in deterministic mode: one cycle per period of the log's own time, each
/// message arriving at its recorded time. Independent of the machine: two runs are bit-identical.
/// The log also contains messages of the daemon itself and of others; only its inputs are passed
/// on. Throws std::runtime_error, with file and byte offset, if the log cannot be read, its time
/// jumps by more than an hour, or it holds no SIM_TICK although these are to pace the cycles.
ReplayResult replay(const config::Node& configuration, const ReplayOptions& options);

}  // namespace palpate::replay
