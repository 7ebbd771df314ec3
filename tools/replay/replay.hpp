#pragma once

#include <lcm/lcm-cpp.hpp>
#include <string>
#include <unordered_map>
#include <vector>

#include "rt/bus/message_bus.hpp"
#include "rt/daemon/daemon.hpp"

namespace palpate::replay {

struct ReplayOptions {
  std::string log;     // recorded on the control URL
  std::string output;  // log of everything that the daemon publishes; empty: none
  bool start = false;  // send the event start before the first message
};

struct ReplayResult {
  std::int64_t cycles = 0;
  std::int64_t messages = 0;  // read from the log and offered to the daemon
  std::int64_t shapes = 0;
  std::uint64_t shape_hash = 0;  // FNV-1a over every SHAPE as published, byte by byte
  double duration = 0;           // s of the log
  std::string complaint;         // what of the log was no message, in a line; mostly empty
};

/// Runs a daemon over a log in deterministic mode: a cycle each period of the log's own time, each
/// message arriving at its recorded time. Nothing depends on the machine: two runs are
/// bit-identical. Throws std::runtime_error, with file and byte, where the
/// log cannot be read or its time jumps by more than an hour.
ReplayResult replay(const config::Node& configuration, const ReplayOptions& options);

}  // namespace palpate::replay
