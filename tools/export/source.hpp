#pragma once

#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "tools/export/survey.hpp"

namespace palpate::exporting {

/// Clock of `time`.
enum class Clock {
  kReceived,  // time of reception by the log: one clock for all channels
  // The sender's utime: in lock-step, where all senders use the simulator's clock. For a sender
  // with an unrelated clock (Survey), such as a user, that of the preceding message of the others
  // in the log.
  kSent
};

/// Selection of logs and of their contents.
struct SourceOptions {
  std::vector<std::filesystem::path> logs;
  std::vector<std::filesystem::path> types;  // .lcm files and their folders, of foreign types
  std::vector<std::string> channels;         // names or patterns with * and ?; empty: all
  Clock clock = Clock::kReceived;
  double from = -std::numeric_limits<double>::infinity();  // s
  double to = std::numeric_limits<double>::infinity();     // s, inclusive
  bool quiet = false;                                      // no progress on standard error
};

/// A message of a known type.
struct Message {
  const bus::LoggedEvent& event;
  const log::Record& record;
  double time;         // s, since the start of the logs by the selected clock
  std::int64_t utime;  // us, the same as an absolute time
};

/// A message that fits a type of SourceOptions::types.
struct ForeignMessage {
  const bus::LoggedEvent& event;
  const types::Struct& type;
  double time;         // as of Message
  std::int64_t utime;  // us
};

/// Logs that are read twice: once at construction, to survey their contents, and once for each().
class Source {
 public:
  /// Surveys the logs; damage is reported on standard error. Throws std::runtime_error if a log
  /// cannot be read, or a pattern of channels matches nothing.
  explicit Source(const SourceOptions& options);

  const Survey& found() const { return survey_; }
  const SourceOptions& options() const { return options_; }
  /// Whether the options select it; types that are not palpate's are never selected.
  bool is_selected(const ChannelSurvey& channel) const;
  /// The same for the types of SourceOptions::types.
  bool is_foreign_selected(const ChannelSurvey& channel) const;
  /// us, at which `time` is 0: the earliest of all messages by the selected clock.
  std::int64_t origin() const;
  /// Whether a time (s) is within the selected range.
  bool is_in_time(double time) const { return time >= options_.from && time <= options_.to; }
  double time(std::int64_t utime) const { return 1e-6 * static_cast<double>(utime - origin()); }

  /// Calls `take` for each complete selected message, in the order of reception; `title` precedes
  /// the progress, `take_foreign` for those of other types. May be called repeatedly.
  void each(const std::string& title, const std::function<void(const Message&)>& take,
            const std::function<void(const ForeignMessage&)>& take_foreign = {});
  /// The same for these channels, regardless of the options' channels and times.
  void each_of(const std::string& title, const std::vector<std::string>& channels,
               const std::function<void(const Message&)>& take);
  /// The same for the channels in `wanted`, regardless of their time.
  void read(const std::string& title, const std::function<bool(const ChannelSurvey&)>& wanted,
            const std::function<void(const Message&)>& take,
            const std::function<void(const ForeignMessage&)>& take_foreign = {});

 private:
  bool matches(const ChannelSurvey& channel) const;

  SourceOptions options_;
  types::TypeSet types_;
  log::MergedLog log_;
  Survey survey_;
};

/// Whether a name matches a pattern with * and ?.
bool fits(const std::string& pattern, const std::string& name);

}  // namespace palpate::exporting
