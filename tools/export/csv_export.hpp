#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/export/source.hpp"

namespace palpate::exporting {

/// A file that was written.
struct Written {
  std::filesystem::path file;
  std::string what;        // the channel, or its content
  std::int64_t count = 0;  // rows, messages or images
};

/// Writes each selected channel to FOLDER/CHANNEL.csv, one row per message, and the description of
/// its columns to FOLDER/CHANNEL.columns.csv. The first columns are
///    time            s, since the earliest message of all logs, by the selected clock
///    received_utime  us, when the log received the message
/// followed by the fields of the message, its own utime (us, the sender's clock) first. Arrays are
/// as wide as their longest one in the log; cells beyond those in use are empty. Throws
/// std::runtime_error.
std::vector<Written> export_csv(Source& source, const std::filesystem::path& folder);

}  // namespace palpate::exporting
