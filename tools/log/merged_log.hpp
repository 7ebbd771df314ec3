#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "rt/bus/event_log_reader.hpp"

namespace palpate::log {

/// Several LCM logs read as one: of all next events the earliest, of equally early ones that of the
/// log named first. So the logs of the three URLs of one run, or pieces of one after rotation, come
/// in the order of their times, as far as each log itself does. Holds one event a log.
class MergedLog {
 public:
  /// Throws std::runtime_error where one of them cannot be read, or there is none.
  explicit MergedLog(const std::vector<std::filesystem::path>& logs);

  /// The next event, valid until the next call; nullptr at the end of all. Throws as
  /// bus::EventLogReader::next.
  const bus::LoggedEvent* next();
  void rewind();

  std::int64_t size() const { return size_; }    // of all files, bytes
  std::int64_t place() const { return place_; }  // what of them has been read, bytes, about

  /// A line for each log that is damaged or cut short: what, where, and how far it could be read.
  /// Of what has been read.
  std::vector<std::string> complaints() const;

 private:
  struct Source {
    std::filesystem::path path;
    std::unique_ptr<bus::EventLogReader> reader;
    const bus::LoggedEvent* head = nullptr;
    std::int64_t size = 0;
    std::int64_t last = -1;  // byte where the last whole event ends
    std::int64_t events = 0;
  };
  void advance(Source& source);

  std::vector<Source> sources_;
  Source* current_ = nullptr;  // whose head was handed out
  bool begun_ = false;
  std::int64_t size_ = 0, place_ = 0;
};

}  // namespace palpate::log
