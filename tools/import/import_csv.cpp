#include "tools/import/import_csv.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <lcm/lcm-cpp.hpp>
#include <stdexcept>

#include "tools/import/encoder.hpp"

namespace palpate::import {
namespace {

double seconds_in(const std::string& unit) {
  static const std::map<std::string, double> kUnits = {
      {"s", 1}, {"ms", 1e-3}, {"us", 1e-6}, {"ns", 1e-9}};
  const auto found = kUnits.find(unit);
  if (found == kUnits.end())
    throw std::invalid_argument("unknown unit of time '" + unit + "'; allowed: s, ms, us, ns");
  return found->second;
}

void check_channel(const std::string& channel) {
  const bool valid = !channel.empty() && channel.size() < 64 &&
                     std::all_of(channel.begin(), channel.end(), [](char c) {
                       return (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
                     });
  if (!valid)
    throw std::invalid_argument("channel '" + channel + "' must be 1 to 63 of A-Z, 0-9 and _");
}

/// All that a file lacks is one error, so that it is mended once.
void require_columns(const recordings::CsvReader& csv, const ImportOptions& options) {
  std::vector<std::string> columns;
  if (options.rate <= 0) columns.push_back(options.time_column);
  for (const auto& item : options.where) columns.push_back(item.first);
  for (const Stream& stream : options.streams) {
    const std::vector<std::string> needed = needed_columns(stream.format, stream.columns);
    columns.insert(columns.end(), needed.begin(), needed.end());
  }
  try {
    csv.require_columns(columns);
  } catch (const recordings::CsvError& error) {
    throw recordings::CsvError(std::string(error.what()) +
                               "; palpate-import --formats lists the fields of each format");
  }
}

/// A log that is renamed to its final name when complete.
class NewLog {
 public:
  explicit NewLog(const std::string& path) : path_(path), part_(path + ".part") {
    log_ = std::make_unique<lcm::LogFile>(part_, "w");
    if (!log_->good()) throw std::runtime_error(path + ": cannot be written");
  }
  ~NewLog() {
    if (log_ == nullptr) return;
    log_.reset();
    std::remove(part_.c_str());
  }
  NewLog(const NewLog&) = delete;
  NewLog& operator=(const NewLog&) = delete;

  void write(std::int64_t utime, const std::string& channel, std::vector<std::uint8_t>& bytes) {
    lcm::LogEvent event{};
    event.timestamp = utime;
    event.channel = channel;
    event.datalen = static_cast<std::int32_t>(bytes.size());
    event.data = bytes.data();
    if (log_->writeEvent(&event) != 0) throw std::runtime_error(path_ + ": writing failed");
  }

  void finish() {
    log_.reset();
    std::filesystem::rename(part_, path_);
  }

 private:
  std::string path_;
  std::string part_;
  std::unique_ptr<lcm::LogFile> log_;
};

}  // namespace

ImportSummary import_csv(const ImportOptions& options) {
  if (options.streams.empty()) throw std::invalid_argument("no stream to import");
  const double unit = seconds_in(options.time_unit);
  recordings::CsvReader csv(options.input, {options.delimiter});
  require_columns(csv, options);
  const int time_column = options.rate > 0 ? -1 : csv.column(options.time_column);
  std::vector<std::pair<int, std::string>> where;
  for (const auto& [column, text] : options.where) where.emplace_back(csv.column(column), text);

  ImportSummary summary;
  std::vector<std::unique_ptr<Encoder>> encoders;
  for (const Stream& stream : options.streams) {
    check_channel(stream.channel);
    if (!summary.messages.emplace(stream.channel, 0).second)
      throw std::invalid_argument("channel " + stream.channel + " is given twice");
    try {
      encoders.push_back(make_encoder(stream.format, stream.columns, csv));
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(stream.channel + ": " + error.what());
    }
  }

  NewLog log(options.output);
  while (csv.next()) {
    const bool chosen = std::all_of(where.begin(), where.end(), [&](const auto& condition) {
      return csv.text(condition.first) == condition.second;
    });
    if (!chosen) continue;
    const double time = time_column < 0 ? static_cast<double>(summary.rows) / options.rate
                                        : unit * csv.number(time_column);
    const auto utime = static_cast<std::int64_t>(std::llround((time + options.start) * 1e6));
    if (summary.rows == 0) summary.first_utime = utime;
    if (summary.rows > 0 && utime < summary.last_utime)
      csv.fail(time_column,
               "time goes back by " + std::to_string(summary.last_utime - utime) + " us");
    summary.last_utime = utime;
    for (std::size_t i = 0; i < encoders.size(); ++i) {
      std::int64_t& count = summary.messages[options.streams[i].channel];
      const MessageHead head{utime, static_cast<std::int32_t>(count), options.session};
      std::vector<std::uint8_t> bytes = encoders[i]->encode(csv, head);
      log.write(utime, options.streams[i].channel, bytes);
      ++count;
    }
    ++summary.rows;
  }
  if (summary.rows == 0) throw recordings::CsvError(options.input + ": no row to import");
  log.finish();
  return summary;
}

const std::vector<std::string>& preset_names() {
  static const std::vector<std::string> kNames = {"biotac_foam_bar"};
  return kNames;
}

std::vector<Stream> preset_streams(const std::string& name) {
  if (name == "biotac_foam_bar")
    return {{"BIOTAC_0", "biotac", {}}, {"FT_TRUTH", "force_torque", {}}};
  throw std::invalid_argument("unknown preset '" + name + "'; allowed: " + preset_names().front());
}

char delimiter_of(const std::string& name) {
  static const std::map<std::string, char> kDelimiters = {
      {"auto", 0}, {"comma", ','}, {"semicolon", ';'}, {"tab", '\t'}};
  const auto found = kDelimiters.find(name);
  if (found != kDelimiters.end()) return found->second;
  throw std::invalid_argument("unknown delimiter '" + name +
                              "'; allowed: auto, comma, semicolon, tab");
}

void read_map(const config::Node& root, ImportOptions& options) {
  options.delimiter =
      delimiter_of(root.choice("delimiter", {"auto", "comma", "semicolon", "tab"}, "auto"));
  options.time_column = root.text("time_column", options.time_column);
  options.time_unit = root.choice("time_unit", {"s", "ms", "us", "ns"}, options.time_unit);
  options.rate = root.number("rate", {0, 1e6}, options.rate);
  options.start = root.number("start", {}, options.start);
  const config::Node where = root.child_or_empty("where");
  for (const std::string& column : where.keys()) options.where[column] = where.text(column);
  for (const config::Node& node : root.list("streams")) {
    Stream stream;
    stream.channel = node.text("channel");
    stream.format = node.choice("format", format_names());
    const config::Node columns = node.child_or_empty("columns");
    for (const std::string& field : columns.keys()) stream.columns[field] = columns.text(field);
    options.streams.push_back(stream);
  }
  root.check_all_used();
}

}  // namespace palpate::import
