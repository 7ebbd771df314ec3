#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "rt/config/node.hpp"

namespace palpate::import {

/// One channel of the log to be written.
struct Stream {
  std::string channel;                         // [A-Z0-9_]+
  std::string format;                          // see format_names()
  std::map<std::string, std::string> columns;  // field -> "[-]column[:unit]" or "=constant"
};

struct ImportOptions {
  std::string input;   // .csv, or the same compressed by gzip
  std::string output;  // LCM log; written completely or not at all
  std::vector<Stream> streams;
  std::string time_column = "t";
  std::string time_unit = "s";  // s, ms, us or ns
  double rate = 0;              // Hz: if > 0, rows are equidistant and time_column is not read
  double start = 0;             // s, added to every time
  char delimiter = 0;           // ',', ';' or '\t'; 0: found from the header line
  std::int64_t session = 0;
  /// Only rows with this text in a column; empty: all.
  std::map<std::string, std::string> where;
};

struct ImportSummary {
  std::int64_t rows = 0;
  std::int64_t first_utime = 0;
  std::int64_t last_utime = 0;
  std::map<std::string, std::int64_t> messages;  // by channel
};

/// One message per row and stream, with the row's time as utime and as time of the log's event.
/// Throws CsvError, std::invalid_argument or std::runtime_error, and then leaves no file behind.
ImportSummary import_csv(const ImportOptions& options);

/// Streams of a recording with known columns: biotac_foam_bar (BIOTAC_0, and the recorded
/// force-torque ground truth on FT_TRUTH). Throws std::invalid_argument listing the presets.
std::vector<Stream> preset_streams(const std::string& name);
const std::vector<std::string>& preset_names();

/// Delimiter by its name: comma, semicolon, tab; 0 for auto. Throws std::invalid_argument.
char delimiter_of(const std::string& name);

/// Reads keys delimiter, time_column, time_unit, rate, start, where {column: text} and streams, a
/// list of {channel, format, columns: {field: description}}, into `options`. Throws config::Error.
void read_map(const config::Node& root, ImportOptions& options);

}  // namespace palpate::import
