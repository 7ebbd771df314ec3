#pragma once

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "tools/export/csv_export.hpp"

namespace palpate::exporting {

/// Which events of logs another log gets.
struct LogSelection {
  std::vector<std::filesystem::path> logs;
  std::vector<std::string> channels;  // names or patterns with * and ?; empty: all
  std::vector<std::string> without;   // the same, of channels to be left out
  double from = -std::numeric_limits<double>::infinity();  // s, since the first event
  double to = std::numeric_limits<double>::infinity();     // s, inclusive
  bool quiet = false;                                      // no progress on standard error
};

/// Writes the selected events of several logs, of known and unknown types, to one LCM log: ordered
/// by the time of their reception, which they keep, with new numbers. Damage of the logs is
/// reported on standard error. The file has its name only when it is complete. Throws
/// std::runtime_error: a log that cannot be read, a pattern that fits no channel, no event that is
/// selected, an output that is one of the logs.
Written export_log(const LogSelection& selection, const std::filesystem::path& output);

}  // namespace palpate::exporting
