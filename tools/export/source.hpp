#pragma once

#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "tools/export/survey.hpp"

namespace palpate::exporting {

/// Which clock `time` goes by.
enum class Clock {
  kReceived,  // when the log received a message: one clock for all channels
  // The sender's utime: in lock-step, where all follow the simulator. Whoever has a strange clock
  // (Survey), as a user, sent when the last of the others before it in the log did.
  kSent
};

/// What of which logs is read.
struct SourceOptions {
  std::vector<std::filesystem::path> logs;
  std::vector<std::string> channels;  // names or patterns with * and ?; empty: all
  Clock clock = Clock::kReceived;
  double from = -std::numeric_limits<double>::infinity();  // s
  double to = std::numeric_limits<double>::infinity();     // s, inclusive
  bool quiet = false;                                      // no progress on standard error
};

/// A message of one of our types.
struct Message {
  const bus::LoggedEvent& event;
  const log::Record& record;
  double time;         // s, since the beginning of the logs by the clock chosen
  std::int64_t utime;  // us, the same as the clock reads
};

/// Logs read twice: once when made, to know what they hold, and once for each().
class Source {
 public:
  /// Surveys the logs; complaints about damage go to standard error. Throws std::runtime_error
  /// where a log cannot be read, or a pattern of channels fits nothing in them.
  explicit Source(const SourceOptions& options);

  const Survey& found() const { return survey_; }
  const SourceOptions& options() const { return options_; }
  /// Whether the options ask for it; strangers are never selected.
  bool is_selected(const ChannelSurvey& channel) const;
  /// us, where `time` is 0: of all messages the earliest by the clock chosen.
  std::int64_t origin() const;
  /// Whether a time (s) is one that the options ask for.
  bool is_in_time(double time) const { return time >= options_.from && time <= options_.to; }
  double time(std::int64_t utime) const { return 1e-6 * static_cast<double>(utime - origin()); }

  /// Calls `take` for each whole message that is selected, in the order of reception; `title`
  /// stands before the progress. May be called again.
  void each(const std::string& title, const std::function<void(const Message&)>& take);
  /// The same of these channels alone, whatever the options say of channels and times.
  void each_of(const std::string& title, const std::vector<std::string>& channels,
               const std::function<void(const Message&)>& take);
  /// The same of the channels that are `wanted`, whatever their time.
  void read(const std::string& title, const std::function<bool(const ChannelSurvey&)>& wanted,
            const std::function<void(const Message&)>& take);

 private:
  SourceOptions options_;
  log::MergedLog log_;
  Survey survey_;
};

/// Whether a name fits a pattern with * and ?.
bool fits(const std::string& pattern, const std::string& name);

}  // namespace palpate::exporting
