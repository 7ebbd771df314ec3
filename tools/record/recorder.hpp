#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "tools/record/listener.hpp"
#include "tools/record/log_files.hpp"
#include "tools/record/message_types.hpp"

namespace palpate::record {

struct RecorderOptions {
  std::vector<std::string> labels;  // of the URLs, in the order of Heard::source
  std::string name;    // of the log; with several URLs each has its own, with its label
  bool merge = false;  // all URLs in one log
  LogFileOptions files;
  std::string channels = ".*";
  bool invert_channels = false;
  types::TypeSet types;           // known besides palpate's
  bool known_only = false;        // omit messages of unknown types
  double flush_interval = 0.1;    // s
  double max_unwritten_mb = 100;  // received but not written; beyond it messages are dropped
  double min_free_mb = 200;       // on the disk; below it the recording ends
};

/// Statistics of one channel of one URL.
struct ChannelSummary {
  int source = 0;
  std::string channel;
  std::string type;  // empty: unknown
  std::int64_t messages = 0;
  std::int64_t bytes = 0;    // of their data
  std::int64_t lost = 0;     // by the gaps in their sequence numbers
  std::int64_t misfits = 0;  // with a known fingerprint that cannot be decoded as its type
  int senders = 0;           // received from, each start of one counted
  std::int64_t first_utime = 0, last_utime = 0;
};

/// Bytes available to an ordinary user on the disk of `folder`.
using FreeSpace = std::function<std::int64_t(const std::string& folder)>;
std::int64_t free_space_of_system(const std::string& folder);

/// Receives messages in one thread and writes them in another. Messages that the writer cannot keep
/// up with are dropped and counted; the receiver never waits for the disk.
class Recorder {
 public:
  /// Opens the logs. Throws as LogFiles does, std::invalid_argument for a wrong pattern, and
  /// std::runtime_error if there is too little space to begin with.
  explicit Recorder(RecorderOptions options, FreeSpace free_space = free_space_of_system);

  /// The receiver's side.
  void take(const Heard& heard);

  /// The writer's side: writes what was received, flushes periodically, checks the space once a
  /// second. False if too little of it is left: call finish() then. `now_ns`: CLOCK_MONOTONIC.
  /// Throws std::runtime_error if a disk write fails.
  bool write(std::int64_t now_ns);
  /// The writer's side: starts the next files.
  void split();
  /// Writes the rest and ends the files; throws as write() does.
  void finish();

  struct Totals {
    std::int64_t messages = 0, bytes = 0, lost = 0, misfits = 0;
    std::int64_t unwritten = 0;  // dropped because too much was queued for the disk
  };
  Totals totals() const;
  std::vector<ChannelSummary> channels() const;  // by source, then name
  std::vector<std::string> files() const;        // after finish(), or from the writer's thread
  const RecorderOptions& options() const noexcept { return options_; }

 private:
  struct Channel {
    ChannelSummary summary;
    SequenceGaps gaps;
  };
  struct Pending {
    int source;
    std::int64_t utime;
    std::string channel;
    std::vector<std::uint8_t> data;
  };
  Channel& channel_of(const Heard& heard);
  void write_pending();
  bool is_space_left() const;

  RecorderOptions options_;
  FreeSpace free_space_;
  ChannelFilter filter_;  // the receiver's
  std::vector<std::unique_ptr<LogFiles>> logs_;
  std::int64_t flush_ns_ = 0, look_ns_ = 0;  // when it was last done

  mutable std::mutex mutex_;  // of all below
  std::vector<Pending> pending_;
  std::int64_t pending_bytes_ = 0;
  std::map<std::pair<int, std::string>, Channel> channels_;
  std::int64_t unwritten_ = 0;
};

}  // namespace palpate::record
