#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <ostream>
#include <set>
#include <string>
#include <vector>

#include "tools/export/foreign_columns.hpp"
#include "tools/log/merged_log.hpp"
#include "tools/log/record.hpp"
#include "tools/log/sequence.hpp"
#include "tools/types/type_set.hpp"

namespace palpate::exporting {

/// First and last of the times, us.
struct TimeSpan {
  std::int64_t first = 0, last = 0;
  bool empty = true;

  void add(std::int64_t utime);
  double seconds() const { return 1e-6 * static_cast<double>(last - first); }
};

/// Messages sent on one channel between a start of a sender and the next.
struct SessionSurvey {
  log::Sequence sequence;
  TimeSpan sent;  // by its clock
};

/// Messages of one type on one channel of a log.
struct ChannelSurvey {
  std::string channel;
  const log::TypeInfo* type = nullptr;     // nullptr: not in lcmtypes/
  const types::Struct* foreign = nullptr;  // nullptr: not among the described types either
  std::uint64_t fingerprint = 0;           // 0 for less than one full message
  std::int64_t messages = 0;
  std::int64_t bytes = 0;
  std::int64_t broken = 0;       // number of messages whose length does not match their type
  TimeSpan received, sent;       // by the log's clock and by the sender's
  std::int64_t longest_gap = 0;  // us, between receptions
  std::map<std::int64_t, SessionSurvey> sessions;  // by the sender's session
  std::vector<int> widths;                         // by field: largest number of values in use
  ForeignColumns foreign_columns;

  bool is_known() const { return type != nullptr || foreign != nullptr; }
  std::string type_name() const;  // empty: unknown
  /// Identifies the type; nullptr: unknown.
  const void* type_address() const {
    return type != nullptr ? static_cast<const void*>(type) : foreign;
  }
  double rate() const;  // Hz, mean; 0 if there are fewer than two
  std::int64_t lost() const;
};

/// Contents of a log, by channel and type.
struct Survey {
  std::vector<ChannelSurvey> channels;  // by name; including unknown types
  std::int64_t events = 0;
  std::int64_t bytes = 0;                 // of the files
  TimeSpan received, sent;                // sent: without unrelated clocks
  std::set<std::int64_t> strange_clocks;  // sessions; see below
  std::vector<std::string> complaints;    // a line for each damaged log

  /// nullptr if the log has none.
  const ChannelSurvey* find(const std::string& channel, const log::TypeInfo* type) const;
  std::int64_t unknown() const;  // messages of unknown types
  std::int64_t broken() const;
};

/// Senders may have different clocks: in lock-step most use the simulator's, while a user's
/// commands use the wall clock. A session's clock counts as unrelated if it is more than an hour
/// away from all times of the session with the most messages.
inline constexpr std::int64_t kStrangeClock = 3'600'000'000;  // us

/// Reads all of `log`. `progress` is called from time to time with the completed fraction, 0 to 1;
/// `foreign`: types that are known besides palpate's, and outlive the survey.
Survey survey(log::MergedLog& log, const std::function<void(double)>& progress = {},
              const types::TypeSet& foreign = {});

/// Contents of a log as a readable table: channels, types, rates, losses, times, unknown messages.
void print_info(const Survey& survey, std::ostream& out);

/// The same as data for programs; times in us, rates in Hz.
nlohmann::json info_json(const Survey& survey);

/// Every field of every channel with a known type: the names for --field and --channel, with units.
void print_fields(const Survey& survey, std::ostream& out);

}  // namespace palpate::exporting
