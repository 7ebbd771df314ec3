#include "tools/recordings/recording_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <palpate/biotac_t.hpp>
#include <palpate/ft_wrench_t.hpp>
#include <palpate/imu_t.hpp>
#include <regex>
#include <stdexcept>

#include "tools/log/log_reader.hpp"
#include "tools/recordings/csv_reader.hpp"

namespace palpate::recordings {
namespace {

constexpr double kGap = 1;  // s, gap between messages that starts a new recording

/// A number or an array of a message.
template <class Message>
struct Field {
  const char* name;
  int count;
  double (*get)(const Message&, int);
};

template <class Message>
const std::vector<Field<Message>>& fields();

template <>
const std::vector<Field<biotac_t>>& fields() {
  static const std::vector<Field<biotac_t>> list{
      {"electrodes", 19, [](const biotac_t& m, int i) -> double { return m.electrodes[i]; }},
      {"pac", 22, [](const biotac_t& m, int i) -> double { return m.pac[i]; }},
      {"pdc", 1, [](const biotac_t& m, int) -> double { return m.pdc; }},
      {"tac", 1, [](const biotac_t& m, int) -> double { return m.tac; }},
      {"tdc", 1, [](const biotac_t& m, int) -> double { return m.tdc; }}};
  return list;
}

template <>
const std::vector<Field<ft_wrench_t>>& fields() {
  static const std::vector<Field<ft_wrench_t>> list{
      {"wrench", 6, [](const ft_wrench_t& m, int i) { return m.wrench[i]; }}};
  return list;
}

template <>
const std::vector<Field<imu_t>>& fields() {
  static const std::vector<Field<imu_t>> list{
      {"acceleration", 3, [](const imu_t& m, int i) { return m.acceleration[i]; }},
      {"angular_velocity", 3, [](const imu_t& m, int i) { return m.angular_velocity[i]; }}};
  return list;
}

template <>
const std::vector<Field<robot_state_t>>& fields() {
  static const std::vector<Field<robot_state_t>> list{
      {"q", 16, [](const robot_state_t& m, int i) { return m.q[i]; }},
      {"dq", 16, [](const robot_state_t& m, int i) { return m.dq[i]; }},
      {"tau", 16, [](const robot_state_t& m, int i) { return m.tau[i]; }},
      {"position", 3, [](const robot_state_t& m, int i) { return m.position[i]; }},
      {"quaternion", 4, [](const robot_state_t& m, int i) { return m.quaternion[i]; }},
      {"twist", 6, [](const robot_state_t& m, int i) { return m.twist[i]; }}};
  return list;
}

/// All messages of one channel.
class Source {
 public:
  virtual ~Source() = default;
  virtual void collect(log::LogReader& log, const std::string& channel) = 0;
  virtual std::size_t size() const = 0;
  virtual std::int64_t utime(std::size_t message) const = 0;
  /// Index and length of a field; -1 if there is none of that name.
  virtual int field(const std::string& name, int& count) const = 0;
  virtual double value(std::size_t message, int field, int index) const = 0;
};

template <class Message>
class SourceOf : public Source {
 public:
  void collect(log::LogReader& log, const std::string& channel) override {
    log.collect(channel, messages_);
  }
  std::size_t size() const override { return messages_.size(); }
  std::int64_t utime(std::size_t message) const override { return messages_[message].utime; }
  int field(const std::string& name, int& count) const override {
    for (std::size_t i = 0; i < fields<Message>().size(); ++i) {
      if (fields<Message>()[i].name != name) continue;
      count = fields<Message>()[i].count;
      return static_cast<int>(i);
    }
    return -1;
  }
  double value(std::size_t message, int field, int index) const override {
    return fields<Message>()[field].get(messages_[message], index);
  }

 private:
  std::vector<Message> messages_;
};

std::unique_ptr<Source> source_of(const std::string& channel) {
  static const std::regex biotac("BIOTAC_[0-4](_1)?"), wrench("FT_WRENCH(_1)?"), imu("IMU(_1)?"),
      robot("ROBOT_STATE(_1)?");
  if (std::regex_match(channel, biotac)) return std::make_unique<SourceOf<biotac_t>>();
  if (std::regex_match(channel, wrench)) return std::make_unique<SourceOf<ft_wrench_t>>();
  if (std::regex_match(channel, imu)) return std::make_unique<SourceOf<imu_t>>();
  if (std::regex_match(channel, robot)) return std::make_unique<SourceOf<robot_state_t>>();
  return nullptr;
}

/// Source of a column.
struct Column {
  std::string name;
  std::string channel;
  int field = 0;
  int index = 0;
};

using Sources = std::map<std::string, std::unique_ptr<Source>>;

Column parse(const std::string& name, const std::string& where, Sources& sources) {
  static const std::regex form("([A-Z0-9_]+)\\.([a-z_]+)(?:\\[([0-9]{1,3})\\])?");
  std::smatch parts;
  if (!std::regex_match(name, parts, form))
    throw std::runtime_error(where + "of a log is named CHANNEL.field or CHANNEL.field[index]");
  Column column{name, parts[1], 0, parts[3].matched ? std::stoi(parts[3]) : 0};
  auto& source = sources[column.channel];
  if (!source) source = source_of(column.channel);
  if (!source)
    throw std::runtime_error(where + "channel " + column.channel +
                             " is none of BIOTAC_0 to 4, FT_WRENCH, IMU, ROBOT_STATE");
  int count = 0;
  column.field = source->field(parts[2], count);
  if (column.field < 0)
    throw std::runtime_error(where + "its messages have no field '" + parts[2].str() + "'");
  if (parts[3].matched != (count > 1))
    throw std::runtime_error(where + (count > 1 ? "an index is missing" : "has no index"));
  if (column.index >= count)
    throw std::runtime_error(where + "the index must be below " + std::to_string(count));
  return column;
}

class TableBuilder {
 public:
  TableBuilder(std::string path, std::size_t columns)
      : path_(std::move(path)), columns_(static_cast<Eigen::Index>(columns)) {}

  void add(double time, const std::vector<double>& row) {
    if (!times_.empty() && time - times_.back() > kGap) finish();
    times_.push_back(time);
    cells_.insert(cells_.end(), row.begin(), row.end());
  }

  std::vector<Table> take() {
    finish();
    return std::move(tables_);
  }

 private:
  void finish() {
    const std::string name =
        path_.substr(path_.find_last_of('/') + 1) + ":" + std::to_string(tables_.size());
    if (times_.size() < 2)
      throw std::runtime_error(path_ + ": recording " + std::to_string(tables_.size()) +
                               " has fewer than two rows with all channels");
    const auto rows = static_cast<Eigen::Index>(times_.size());
    Table table;
    table.name = name;
    table.time = Eigen::Map<Eigen::VectorXd>(times_.data(), rows);
    table.time.array() -= times_.front();
    table.rows = Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
        cells_.data(), rows, columns_);
    tables_.push_back(std::move(table));
    times_.clear();
    cells_.clear();
  }

  std::string path_;
  Eigen::Index columns_;
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
  log::LogReader log(time == "sent" ? log::LogClock::kSent : log::LogClock::kReceived);
  for (auto& [channel, source] : sources) source->collect(log, channel);
  log.read(path);
  for (const auto& [channel, source] : sources)
    if (source->size() == 0)
      throw std::runtime_error(path + ": no message of channel " + channel + " that can be read" +
                               (log.undecodable() > 0 ? " (some are of another type)" : ""));

  const Source& leader = *sources.at(columns.front().channel);
  std::map<std::string, std::size_t> next;  // first message that is later than the row
  TableBuilder tables(path, columns.size());
  std::vector<double> row(columns.size());
  std::int64_t before = 0;
  for (std::size_t k = 0; k < leader.size(); ++k) {
    const std::int64_t now = leader.utime(k);
    if (k > 0 && now < before)
      throw std::runtime_error(path + ": time of " + columns.front().channel + " runs backwards");
    if (k > 0 && now == before) continue;  // the same time twice: the first counts
    before = now;
    bool complete = true;
    for (const auto& [channel, source] : sources) {
      std::size_t& later = next[channel];
      while (later < source->size() && source->utime(later) <= now) ++later;
      complete = complete && later > 0;
    }
    if (!complete) continue;
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const Column& column = columns[c];
      const std::size_t message =
          column.channel == columns.front().channel ? k : next[column.channel] - 1;
      row[c] = sources.at(column.channel)->value(message, column.field, column.index);
      if (!std::isfinite(row[c]))
        throw std::runtime_error(path + ": column '" + column.name + "': message " +
                                 std::to_string(message) + " is not finite");
    }
    tables.add(1e-6 * static_cast<double>(now), row);
  }
  return tables.take();
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

  std::vector<Table> tables;
  std::string label;
  std::vector<double> times;
  std::vector<double> cells;
  const auto finish = [&] {
    if (times.size() < 2) csv.fail("a recording of fewer than two rows ends here");
    using Rows = Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;
    Table table;
    table.name = path.substr(path.find_last_of('/') + 1) + (separator.empty() ? "" : ":" + label);
    table.time = Eigen::Map<Eigen::VectorXd>(times.data(), static_cast<Eigen::Index>(times.size()));
    table.time.array() -= times.front();
    table.rows = Rows(cells.data(), static_cast<Eigen::Index>(times.size()),
                      static_cast<Eigen::Index>(indices.size()));
    tables.push_back(std::move(table));
    times.clear();
    cells.clear();
  };
  while (csv.next()) {
    if (separator_column >= 0 && csv.text(separator_column) != label) {
      if (!times.empty()) finish();
      label = csv.text(separator_column);
    }
    const double t = csv.number(time_column);
    if (!times.empty() && t <= times.back()) {
      if (t < times.back()) csv.fail(time_column, "time runs backwards");
      continue;  // the same time twice: the first counts
    }
    times.push_back(t);
    for (const int index : indices) cells.push_back(csv.number(index));
  }
  finish();
  return tables;
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
