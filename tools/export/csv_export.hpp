#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/export/source.hpp"

namespace palpate::exporting {

/// A file that was written.
struct Written {
  std::filesystem::path file;
  std::string what;        // the channel, or what it shows
  std::int64_t count = 0;  // rows, messages or pictures
};

/// Writes each selected channel to FOLDER/CHANNEL.csv, one row a message, and what its columns mean
/// to FOLDER/CHANNEL.columns.csv. The first columns are
///   time            s, since the earliest message of all logs, by the clock that was chosen
///   received_utime  us, when the log received the message
/// then come the fields of the message, its own utime (us, the sender's clock) first. Arrays are as
/// wide as their longest one in the log; cells beyond those in use are empty. Throws
/// std::runtime_error.
std::vector<Written> export_csv(Source& source, const std::filesystem::path& folder);

}  // namespace palpate::exporting
