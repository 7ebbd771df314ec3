#include "tools/import/import_csv.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <palpate/biotac_t.hpp>
#include <palpate/channels.hpp>
#include <palpate/ft_wrench_t.hpp>
#include <palpate/imu_t.hpp>
#include <palpate/robot_state_t.hpp>
#include <stdexcept>
#include <vector>

#include "core/math/rigid.hpp"
#include "tools/import/fields.hpp"
#include "tools/log/event_log.hpp"

namespace palpate::import {
namespace {

/// First fields of every message.
struct MessageHead {
  std::int64_t utime = 0;  // us
  std::int32_t seq = 0;
  std::int64_t session = 0;
};

/// Turns the current row of a file into the bytes of one message. Throws CsvError if a value does
/// not fit it.
using Encode = std::function<std::vector<std::uint8_t>(const recordings::CsvReader& csv,
                                                       const MessageHead& head)>;

/// fill(csv, mapping, message) writes the fields after the head.
template <class Message, class Fill>
Encode encoder_of(FieldMapping mapping, Fill fill) {
  return [mapping = std::move(mapping), fill](const recordings::CsvReader& csv,
                                              const MessageHead& head) {
    Message message{};
    message.utime = head.utime;
    message.seq = head.seq;
    message.session = head.session;
    fill(csv, mapping, message);
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
    if (message.encode(bytes.data(), 0, static_cast<int>(bytes.size())) < 0)
      csv.fail("the message could not be encoded");
    return bytes;
  };
}

std::int16_t counts(const recordings::CsvReader& csv, const FieldMapping& mapping, int field) {
  const double value = std::round(mapping.value(csv, field));
  using Limits = std::numeric_limits<std::int16_t>;
  if (value < Limits::min() || value > Limits::max())
    csv.fail(mapping.column(field), "does not fit 16 bits");
  return static_cast<std::int16_t>(value);
}

// Indices into the lists of fields.cpp.
constexpr int kQuaternion = 3, kTwist = 7, kJoints = 13, kSpeeds = 29, kEfforts = 45;
constexpr int kMaxJoints = 16;
constexpr int kPac = 19, kPdc = 41, kTac = 42, kTdc = 43;
constexpr int kElectrodes = 19, kPacSlots = 22;

void fill_robot_state(const recordings::CsvReader& csv, const FieldMapping& mapping,
                      robot_state_t& message) {
  message.joint_count = 1;
  for (int i = 0; i < kMaxJoints; ++i) {
    if (mapping.has(kJoints + i)) message.joint_count = i + 1;
    message.q[i] = mapping.value(csv, kJoints + i);
    message.dq[i] = mapping.value(csv, kSpeeds + i);
    message.tau[i] = mapping.value(csv, kEfforts + i);
  }
  for (int i = 0; i < 3; ++i) message.position[i] = mapping.value(csv, i);
  for (int i = 0; i < 4; ++i) message.quaternion[i] = mapping.value(csv, kQuaternion + i);
  for (int i = 0; i < 6; ++i) message.twist[i] = mapping.value(csv, kTwist + i);
  if (!math::is_unit_quaternion(message.quaternion))
    csv.fail("the quaternion is not of unit length");
}

void fill_biotac(const recordings::CsvReader& csv, const FieldMapping& mapping, biotac_t& message) {
  if (mapping.has(0)) message.valid |= biotac_t::VALID_ELECTRODES;
  if (mapping.has(kPac)) message.valid |= biotac_t::VALID_PAC;
  if (mapping.has(kPdc)) message.valid |= biotac_t::VALID_PDC;
  if (mapping.has(kTac) && mapping.has(kTdc)) message.valid |= biotac_t::VALID_TEMPERATURE;
  for (int i = 0; i < kElectrodes; ++i) message.electrodes[i] = counts(csv, mapping, i);
  message.pac_count = 0;
  for (int i = 0; i < kPacSlots && mapping.has(kPac + i); ++i) {
    message.pac[i] = counts(csv, mapping, kPac + i);
    message.pac_count = static_cast<std::int16_t>(i + 1);
  }
  message.pdc = counts(csv, mapping, kPdc);
  message.tac = counts(csv, mapping, kTac);
  message.tdc = counts(csv, mapping, kTdc);
}

/// Throws as FieldMapping, and std::invalid_argument if a biotac has only some of its electrodes,
/// or no fields at all.
Encode make_encoder(const std::string& format, const std::map<std::string, std::string>& described,
                    const recordings::CsvReader& csv) {
  FieldMapping mapping(format, described, csv);
  if (format == "force_torque") {
    return encoder_of<ft_wrench_t>(
        std::move(mapping),
        [](const recordings::CsvReader& row, const FieldMapping& from, ft_wrench_t& to) {
          for (int i = 0; i < 6; ++i) to.wrench[i] = from.value(row, i);
        });
  }
  if (format == "imu") {
    return encoder_of<imu_t>(std::move(mapping), [](const recordings::CsvReader& row,
                                                    const FieldMapping& from, imu_t& to) {
      for (int i = 0; i < 3; ++i) to.acceleration[i] = from.value(row, i);
      for (int i = 0; i < 3; ++i) to.angular_velocity[i] = from.value(row, 3 + i);
    });
  }
  if (format == "robot_state")
    return encoder_of<robot_state_t>(std::move(mapping), fill_robot_state);

  for (int i = 1; i < kElectrodes; ++i)
    if (mapping.has(i) != mapping.has(0))
      throw std::invalid_argument("a biotac needs all of e1 to e19, or none");
  if (!mapping.has_any(0, kTdc + 1))
    throw std::invalid_argument("none of the columns is a biotac's (e1 to e19, pac0, pdc, ...)");
  return encoder_of<biotac_t>(std::move(mapping), fill_biotac);
}

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

/// All that a file lacks is one error, so that it is corrected once.
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
  explicit NewLog(const std::string& path) : path_(path), part_(path + ".part"), log_(part_) {}
  ~NewLog() {
    if (!log_) return;
    log_.reset();
    std::remove(part_.c_str());
  }
  NewLog(const NewLog&) = delete;
  NewLog& operator=(const NewLog&) = delete;

  void write(std::int64_t utime, const std::string& channel, std::vector<std::uint8_t>& bytes) {
    log_->write(channel, utime, bytes);
  }

  void finish() {
    log_.reset();
    std::filesystem::rename(part_, path_);
  }

 private:
  std::string path_;
  std::string part_;
  std::optional<log::EventLog> log_;
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
  std::vector<Encode> encoders;
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
      std::vector<std::uint8_t> bytes = encoders[i](csv, head);
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
    return {{channel::kBiotac0, "biotac", {}}, {"FT_TRUTH", "force_torque", {}}};
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
