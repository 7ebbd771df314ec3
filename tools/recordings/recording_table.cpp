#include "tools/recordings/recording_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>
#include <regex>
#include <stdexcept>

#include "rt/bus/event_log_reader.hpp"
#include "tools/log/record.hpp"
#include "tools/recordings/csv_reader.hpp"

namespace palpate::recordings {
namespace {

constexpr double kGap = 1;  // s, gap between messages that starts a new recording

/// The wanted numbers of all messages of one channel.
struct Source {
  const log::TypeInfo* type = nullptr;
  std::vector<std::pair<int, int>> wanted;  // field and index of each column
  std::vector<std::int64_t> times;          // us, by message
  std::vector<double> numbers;              // message by message

  std::size_t size() const { return times.size(); }
  double value(std::size_t message, int column) const {
    return numbers[message * wanted.size() + column];
  }
};

using Sources = std::map<std::string, Source>;

/// Null for a channel that holds no sensor's signal.
const log::TypeInfo* type_of(const std::string& channel) {
  static const std::vector<std::pair<std::regex, std::string>> kTypes = {
      {std::regex("BIOTAC_[0-4](_1)?"), "biotac_t"},
      {std::regex("FT_WRENCH(_1)?"), "ft_wrench_t"},
      {std::regex("IMU(_1)?"), "imu_t"},
      {std::regex("ROBOT_STATE(_1)?"), "robot_state_t"}};
  for (const auto& [channels, name] : kTypes) {
    if (!std::regex_match(channel, channels)) continue;
    for (const log::TypeInfo& type : log::types())
      if (type.name == name) return &type;
  }
  return nullptr;
}

/// Where a column stands in the sources.
struct Column {
  std::string name;
  std::string channel;
  int place = 0;  // among the wanted numbers of the channel
};

Column parse(const std::string& name, const std::string& where, Sources& sources) {
  static const std::regex form("([A-Z0-9_]+)\\.([a-z_]+)(?:\\[([0-9]{1,3})\\])?");
  std::smatch parts;
  if (!std::regex_match(name, parts, form))
    throw std::runtime_error(where + "of a log is named CHANNEL.field or CHANNEL.field[index]");
  Source& source = sources[parts[1]];
  source.type = type_of(parts[1]);
  if (source.type == nullptr)
    throw std::runtime_error(where + "channel " + parts[1].str() +
                             " is none of BIOTAC_0 to 4, FT_WRENCH, IMU, ROBOT_STATE");
  const int field = source.type->field(parts[2]);
  if (field < 0)
    throw std::runtime_error(where + "its messages have no field '" + parts[2].str() + "'");
  const log::FieldInfo& info = source.type->fields[field];
  const int index = parts[3].matched ? std::stoi(parts[3]) : 0;
  if (parts[3].matched == info.is_scalar())
    throw std::runtime_error(where + (info.is_scalar() ? "has no index" : "an index is missing"));
  if (!info.is_scalar() && index >= info.sizes.front())
    throw std::runtime_error(where + "the index must be below " +
                             std::to_string(info.sizes.front()));
  source.wanted.emplace_back(field, index);
  return {name, parts[1], static_cast<int>(source.wanted.size()) - 1};
}

/// Reads what the sources want; returns how many messages of their channels cannot be decoded.
int read_log(const std::string& path, bool is_sent, Sources& sources) {
  std::map<const log::TypeInfo*, log::Record> records;
  bus::EventLogReader file(path);
  int undecodable = 0;
  while (const bus::LoggedEvent* event = file.next()) {
    const auto found = sources.find(event->channel);
    if (found == sources.end()) continue;
    Source& source = found->second;
    log::Record& record = records.try_emplace(source.type, *source.type).first->second;
    if (!record.decode(event->data, event->size)) {
      ++undecodable;
      continue;
    }
    source.times.push_back(is_sent ? record.utime() : event->utime);
    for (const auto& [field, index] : source.wanted)
      source.numbers.push_back(record.number(field, index));
  }
  if (!file.complaint().empty()) std::cerr << "warning: " << file.complaint() << std::endl;
  return undecodable;
}

/// Rows of a recording, then of the next.
class TableBuilder {
 public:
  TableBuilder(const std::string& path, std::size_t columns)
      : file_(path.substr(path.find_last_of('/') + 1)), columns_(columns) {}

  void add(double time, const std::vector<double>& row) {
    times_.push_back(time);
    cells_.insert(cells_.end(), row.begin(), row.end());
  }
  const std::vector<double>& times() const { return times_; }
  const std::vector<Table>& tables() const { return tables_; }

  /// Ends a recording, whose name is that of the file and `label`.
  void finish(const std::string& label) {
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const auto rows = static_cast<Eigen::Index>(times_.size());
    Table& table = tables_.emplace_back();
    table.name = file_ + label;
    table.time = Eigen::Map<Eigen::VectorXd>(times_.data(), rows);
    table.time.array() -= times_.front();
    table.rows = Eigen::Map<Rows>(cells_.data(), rows, static_cast<Eigen::Index>(columns_));
    times_.clear();
    cells_.clear();
  }

 private:
  std::string file_;
  std::size_t columns_;
  std::vector<double> times_, cells_;
  std::vector<Table> tables_;
};

}  // namespace

bool is_log(const std::string& path) {
  constexpr std::array<unsigned char, 4> kSyncWord = {0xED, 0xA1, 0xDA, 0x01};
  std::array<unsigned char, 4> begin{};
  std::ifstream file(path, std::ios::binary);
  file.read(reinterpret_cast<char*>(begin.data()), begin.size());
  return file && begin == kSyncWord;
}

std::vector<Table> read_log_tables(const std::string& path, const std::string& time,
                                   const std::vector<std::string>& names) {
  if (time != "sent" && time != "received")
    throw std::runtime_error(path + ": time of a log must be 'sent' or 'received', not '" + time +
                             "'");
  Sources sources;
  std::vector<Column> columns;
  for (const std::string& name : names)
    columns.push_back(parse(name, path + ": column '" + name + "': ", sources));
  const int undecodable = read_log(path, time == "sent", sources);
  for (const auto& [channel, source] : sources)
    if (source.size() == 0)
      throw std::runtime_error(path + ": no message of channel " + channel + " that can be read" +
                               (undecodable > 0 ? " (some are of another type)" : ""));

  const Source& leader = sources.at(columns.front().channel);
  std::map<std::string, std::size_t> next;  // first message that is later than the row
  TableBuilder tables(path, columns.size());
  const auto finish = [&] {
    const std::string number = std::to_string(tables.tables().size());
    if (tables.times().size() < 2)
      throw std::runtime_error(path + ": recording " + number +
                               " has fewer than two rows with all channels");
    tables.finish(":" + number);
  };
  std::vector<double> row(columns.size());
  std::int64_t before = 0;
  for (std::size_t k = 0; k < leader.size(); ++k) {
    const std::int64_t now = leader.times[k];
    if (k > 0 && now < before)
      throw std::runtime_error(path + ": time of " + columns.front().channel + " runs backwards");
    if (k > 0 && now == before) continue;  // the same time twice: the first counts
    before = now;
    bool complete = true;
    for (const auto& [channel, source] : sources) {
      std::size_t& later = next[channel];
      while (later < source.size() && source.times[later] <= now) ++later;
      complete = complete && later > 0;
    }
    if (!complete) continue;
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const Column& column = columns[c];
      const std::size_t message =
          column.channel == columns.front().channel ? k : next[column.channel] - 1;
      row[c] = sources.at(column.channel).value(message, column.place);
      if (!std::isfinite(row[c]))
        throw std::runtime_error(path + ": column '" + column.name + "': message " +
                                 std::to_string(message) + " is not finite");
    }
    const double seconds = 1e-6 * static_cast<double>(now);
    if (!tables.times().empty() && seconds - tables.times().back() > kGap) finish();
    tables.add(seconds, row);
  }
  finish();
  return tables.tables();
}

std::vector<Table> read_tables(const std::string& path, const std::string& time,
                               const std::vector<std::string>& columns,
                               const std::string& separator) {
  if (is_log(path)) {
    if (!separator.empty())
      throw std::runtime_error(path + ": a log has no column '" + separator +
                               "' that separates recordings");
    return read_log_tables(path, time, columns);
  }
  recordings::CsvReader csv(path);
  const int time_column = csv.column(time);
  const int separator_column = separator.empty() ? -1 : csv.column(separator);
  std::vector<int> indices;
  for (const std::string& name : columns) indices.push_back(csv.column(name));

  TableBuilder tables(path, columns.size());
  std::string label;
  const auto finish = [&] {
    if (tables.times().size() < 2) csv.fail("a recording of fewer than two rows ends here");
    tables.finish(separator.empty() ? "" : ":" + label);
  };
  std::vector<double> row(indices.size());
  while (csv.next()) {
    if (separator_column >= 0 && csv.text(separator_column) != label) {
      if (!tables.times().empty()) finish();
      label = csv.text(separator_column);
    }
    const double t = csv.number(time_column);
    if (!tables.times().empty() && t <= tables.times().back()) {
      if (t < tables.times().back()) csv.fail(time_column, "time runs backwards");
      continue;  // the same time twice: the first counts
    }
    std::transform(indices.begin(), indices.end(), row.begin(),
                   [&csv](int index) { return csv.number(index); });
    tables.add(t, row);
  }
  finish();
  return tables.tables();
}

Table resample(const Table& table, double rate, double average) {
  const Eigen::Index n = table.time.size();
  const double tolerance = 1e-6;  // s, tolerance for times written with a few decimals
  const auto count =
      static_cast<Eigen::Index>(std::floor((table.time[n - 1] + tolerance) * rate)) + 1;
  Table result;
  result.name = table.name;
  result.time.resize(count);
  result.rows.resize(count, table.rows.cols());
  Eigen::Index begin = 0, end = 0;  // samples of the window
  for (Eigen::Index k = 0; k < count; ++k) {
    const double t = static_cast<double>(k) / rate;
    result.time[k] = t;
    while (end < n && table.time[end] <= t + tolerance) ++end;
    while (begin < end - 1 && table.time[begin] <= t - average + tolerance) ++begin;
    if (average <= 0) begin = end - 1;
    result.rows.row(k) = table.rows.middleRows(begin, end - begin).colwise().mean();
  }
  return result;
}

void delay_columns(Table& table, int first, int count, double seconds) {
  const Eigen::Index n = table.time.size();
  const double step = table.time[n - 1] / static_cast<double>(n - 1);
  const Eigen::MatrixXd before = table.rows.middleCols(first, count);
  for (Eigen::Index k = 0; k < n; ++k) {
    const double at =
        std::clamp(static_cast<double>(k) - seconds / step, 0.0, static_cast<double>(n - 1));
    const auto left = std::min(static_cast<Eigen::Index>(at), n - 2);
    const double part = at - static_cast<double>(left);
    table.rows.row(k).segment(first, count) =
        (1 - part) * before.row(left) + part * before.row(left + 1);
  }
}

}  // namespace palpate::recordings
