#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "tools/log/merged_log.hpp"
#include "tools/log/record.hpp"
#include "tools/log/sequence.hpp"

namespace palpate::exporting {

/// First and last of times, us.
struct TimeSpan {
  std::int64_t first = 0, last = 0;
  bool empty = true;

  void add(std::int64_t utime);
  double seconds() const { return 1e-6 * static_cast<double>(last - first); }
};

/// What one start of a sender sent on one channel.
struct SessionSurvey {
  log::Sequence sequence;
  TimeSpan sent;  // by its clock
};

/// What a log holds of one type on one channel.
struct ChannelSurvey {
  std::string channel;
  const log::TypeInfo* type = nullptr;  // nullptr: none of lcmtypes/
  std::uint64_t fingerprint = 0;        // 0 for less than one
  std::int64_t messages = 0;
  std::int64_t bytes = 0;
  std::int64_t broken = 0;       // of the messages, those whose length is not what their type says
  TimeSpan received, sent;       // by the log's clock and by the sender's
  std::int64_t longest_gap = 0;  // us, between receptions
  std::map<std::int64_t, SessionSurvey> sessions;  // by the sender's session
  std::vector<int> widths;                         // by field: most numbers that were in use

  double rate() const;  // Hz, mean; 0 where fewer than two
  std::int64_t lost() const;
};

/// What a log holds, by channel and type.
struct Survey {
  std::vector<ChannelSurvey> channels;  // by name; strangers too
  std::int64_t events = 0;
  std::int64_t bytes = 0;                 // of the files
  TimeSpan received, sent;                // sent: without strange clocks
  std::set<std::int64_t> strange_clocks;  // sessions; see below
  std::vector<std::string> complaints;    // a line for each damaged log

  /// nullptr where the log has none.
  const ChannelSurvey* find(const std::string& channel, const log::TypeInfo* type) const;
  std::int64_t unknown() const;  // messages of no type of ours
  std::int64_t broken() const;
};

/// Senders need not share a clock: in lock-step most go by the simulator's, while a user's commands
/// go by the wall's. A session is strange where its clock is more than an hour away from all that
/// the session with the most messages sent.
inline constexpr std::int64_t kStrangeClock = 3'600'000'000;  // us

/// Reads all of `log`. `progress` gets the part that is done, 0 to 1, now and then.
Survey survey(log::MergedLog& log, const std::function<void(double)>& progress = {});

}  // namespace palpate::exporting
