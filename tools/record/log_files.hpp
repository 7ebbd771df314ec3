#pragma once

#include <lcm/eventlog.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::record {

/// Naming of files and rotation; as in lcm-logger.
struct LogFileOptions {
  double split_mb = 0;     // start another file after this many MB (1e6 bytes); 0: never
  int rotate = 0;          // FILE.0 is written, FILE.1 to FILE.(rotate - 1) are older; 0: none
  bool increment = false;  // FILE.00, FILE.01, ...: the first that does not exist
  bool force = false;      // overwrite FILE
};

/// `name` with the label inserted before its extension, or appended with .lcmlog: run.lcmlog and
/// run become run.control.lcmlog.
std::string labelled(const std::string& name, const std::string& label);

/// The name expanded by strftime with the local time `now`, in s. Throws std::invalid_argument if
/// the result is empty.
std::string by_time(const std::string& pattern, std::int64_t now);

/// Writes one LCM event log, in as many files as the options specify. Never overwrites an existing
/// file, except with --force or by rotation.
class LogFiles {
 public:
  /// Opens the first file. Throws std::runtime_error naming the file and the reason, and
  /// std::invalid_argument for contradictory options.
  LogFiles(std::string name, const LogFileOptions& options);
  ~LogFiles();
  LogFiles(const LogFiles&) = delete;
  LogFiles& operator=(const LogFiles&) = delete;

  /// Appends an event. Throws std::runtime_error naming the file if the disk write fails.
  void write(std::int64_t utime, std::string_view channel, const std::uint8_t* data, int size);
  /// Flushes everything written to the system. Throws as write() does.
  void flush();
  /// Starts the next file if increment or rotation is enabled; otherwise does nothing.
  void split();
  /// Flushes and ends. Throws as write() does.
  void close();

  /// All files of this log that were written and still exist, the current one last.
  std::vector<std::string> files() const;
  std::int64_t bytes() const noexcept { return bytes_before_ + bytes_; }

 private:
  void open();
  std::string new_file();
  void rotate();

  struct Destroy {
    void operator()(lcm_eventlog_t* log) const noexcept { lcm_eventlog_destroy(log); }
  };
  std::string name_;
  LogFileOptions options_;
  std::string path_;  // that is written
  std::unique_ptr<lcm_eventlog_t, Destroy> log_;
  std::vector<std::string> finished_;  // except with rotation, where their names change
  int opened_ = 0;
  int next_number_ = 0;
  std::int64_t bytes_ = 0, bytes_before_ = 0;
};

}  // namespace palpate::record
