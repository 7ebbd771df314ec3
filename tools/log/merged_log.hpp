#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "rt/bus/event_log_reader.hpp"

namespace palpate::log {

/// Several LCM logs read as one, ordered by time; of simultaneous events that of the log named
/// first. The logs of the three URLs of a run, or the pieces of a log after rotation, are thus
/// merged in the order of their times, provided that each log is ordered. Holds one event per log.
class MergedLog {
 public:
  /// Throws std::runtime_error if one of them cannot be read, or there is none.
  explicit MergedLog(const std::vector<std::filesystem::path>& logs);

  /// The next event, valid until the next call; nullptr at the end of all logs. Throws as
  /// bus::EventLogReader::next.
  const bus::LoggedEvent* next();
  void rewind();

  std::int64_t size() const { return size_; }    // of all files, bytes
  std::int64_t place() const { return place_; }  // bytes read so far, approximately

  /// One line for each log that is damaged or truncated: what, where, and how far it could be read.
  /// Covers the part read so far.
  std::vector<std::string> complaints() const;

 private:
  struct Source {
    std::filesystem::path path;
    std::unique_ptr<bus::EventLogReader> reader;
    const bus::LoggedEvent* head = nullptr;
    std::int64_t size = 0;
    std::int64_t last = -1;  // byte offset of the end of the last complete event
    std::int64_t events = 0;
  };
  void advance(Source& source);

  std::vector<Source> sources_;
  Source* current_ = nullptr;  // whose head was handed out
  bool begun_ = false;
  std::int64_t size_ = 0, place_ = 0;
};

}  // namespace palpate::log
