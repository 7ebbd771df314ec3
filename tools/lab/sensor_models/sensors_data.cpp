#include "tools/lab/sensor_models/sensors_data.hpp"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "core/sensing/linear_tactile.hpp"
#include "core/sensing/recurrent_observer_inputs.hpp"
#include "rt/config/installation.hpp"
#include "rt/inference/model_card.hpp"
#include "tools/recordings/csv_reader.hpp"
#include "tools/recordings/wrist_data.hpp"

namespace palpate::sensor_models {
namespace {

using sensing::kElectrodeCount;
using sensing::kTactileInputCount;

constexpr SensorKind kSensorsDataKinds[] = {SensorKind::kForce, SensorKind::kDirection,
                                            SensorKind::kWrist};
constexpr const char* kPac = "pac0";
constexpr double kRestPressure =
    15;  // counts of PDC above the quietest rows that still count as rest

recordings::Plan preset(const std::string& name) {
  return recordings::read_plan(config::Node::load_file(
      (config::data_folder() / "tools/train/presets" / (name + ".yaml")).string()));
}

std::vector<std::string> tactile_columns(SensorKind kind) {
  std::vector<std::string> columns;
  for (int i = 1; i <= kElectrodeCount; ++i) columns.push_back("e" + std::to_string(i));
  columns.push_back(kPac);
  columns.push_back("pdc");
  for (const std::string& column : recordings::columns_of(plan_of(kind).data.outputs))
    columns.push_back(column);
  return columns;
}

std::vector<std::string> columns_of(SensorKind kind) {
  return kind == SensorKind::kWrist ? recordings::wrist_columns(plan_of(kind).data.wrist)
                                    : tactile_columns(kind);
}

std::string first_present(const recordings::CsvReader& csv, const std::vector<std::string>& names) {
  for (const std::string& name : names)
    if (csv.has_column(name)) return name;
  return "";
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream bytes;
  bytes << stream.rdbuf();
  return bytes.str();
}

bool ends_with(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

/// Reads the file as recordings of one kind; reports the missing columns if it is not of that kind.
std::string read_as(SensorKind kind, const std::filesystem::path& path, const std::string& name,
                    std::vector<SensorRecording>& recordings) {
  std::vector<std::string> columns = columns_of(kind);
  std::string time, label;
  {
    const recordings::CsvReader csv(path.string());
    time = first_present(csv, {plan_of(kind).data.time, "t", "t_s"});
    label = first_present(csv, {"log", "recording", "run", "trial"});
    std::string missing = time.empty() ? " " + plan_of(kind).data.time : "";
    for (const std::string& column : columns)
      if (!csv.has_column(column) && !(kind == SensorKind::kDirection && column == kPac))
        missing += " " + column;
    if (!missing.empty()) return missing;
    if (!csv.has_column(kPac))
      columns.erase(std::remove(columns.begin(), columns.end(), kPac), columns.end());
  }
  const bool lacks_pac =
      kind != SensorKind::kWrist && columns.size() < tactile_columns(kind).size();
  std::vector<recordings::Table> tables =
      recordings::read_tables(path.string(), time, columns, label);
  const std::string sha256 = inference::sha256_of(bytes_of(path));
  for (recordings::Table& table : tables) {
    if (lacks_pac) {
      Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(table.rows.rows(), table.rows.cols() + 1);
      rows.leftCols(kElectrodeCount) = table.rows.leftCols(kElectrodeCount);
      rows.rightCols(table.rows.cols() - kElectrodeCount) =
          table.rows.rightCols(table.rows.cols() - kElectrodeCount);
      table.rows = rows;
    }
    SensorRecording recording{kind, name, name, sha256, std::move(table)};
    if (tables.size() > 1)
      recording.name += recording.table.name.substr(recording.table.name.rfind(':'));
    recordings.push_back(std::move(recording));
  }
  return "";
}

SensorTrack tactile_track(const SensorRecording& recording) {
  const recordings::DataPlan& plan = plan_of(recording.kind).data;
  SensorTrack track;
  track.recording = recording;
  const recordings::Table& table = recording.table;
  track.time = table.time;
  const Eigen::Index n = table.rows.rows();
  while (track.tare_rows < n && table.time[track.tare_rows] < plan.tare) ++track.tare_rows;
  if (2 * track.tare_rows > n)
    throw std::runtime_error(recording.name + ": is shorter than twice the time for taring");

  const auto pressure = table.rows.col(kTactileInputCount - 1);
  const auto mean_pressure = [&](Eigen::Index begin) {
    return pressure.segment(begin, track.tare_rows).mean();
  };
  Eigen::Index quietest = 0;
  for (Eigen::Index k = 0; k + track.tare_rows <= n; ++k)
    if (mean_pressure(k) < mean_pressure(quietest)) quietest = k;
  if (mean_pressure(0) > mean_pressure(quietest) + kRestPressure) track.tare_begin = quietest;

  Eigen::RowVectorXd rest =
      table.rows.middleRows(track.tare_begin, track.tare_rows).colwise().mean();
  if (!plan.tare_outputs) rest.tail(3).setZero();
  const Eigen::MatrixXd tared = table.rows.rowwise() - rest;
  track.input = tared.leftCols(kTactileInputCount);
  track.truth = tared.rightCols(3);
  for (Eigen::Index k = 0; k < n; ++k)
    track.counts.push_back(plan.contact_column.empty() ||
                           track.input(k, kTactileInputCount - 1) > plan.contact_threshold);
  return track;
}

SensorTrack wrist_track(const SensorRecording& recording) {
  constexpr int kAcceleration = 10;     // index in wrist_columns()
  constexpr double kHalfGravity = 4.9;  // m/s^2
  recordings::DataPlan plan = plan_of(SensorKind::kWrist).data;
  SensorTrack track;
  track.recording = recording;
  track.acceleration_has_gravity =
      recording.table.rows.middleCols(kAcceleration, 3).rowwise().norm().mean() > kHalfGravity;
  plan.wrist.acceleration_has_gravity = track.acceleration_has_gravity;
  const recordings::WristRecording wrist = recordings::load_wrist(plan, recording.table);
  track.time = wrist.time;
  track.input = wrist.inputs;
  track.samples = wrist.samples;
  track.truth.resize(track.time.size(), 6);
  for (std::size_t k = 0; k < wrist.samples.size(); ++k)
    track.truth.row(static_cast<Eigen::Index>(k)) = wrist.samples[k].F_S.vector().transpose();
  track.counts.assign(wrist.samples.size(), true);
  return track;
}

}  // namespace

const char* name_of(SensorKind kind) {
  switch (kind) {
    case SensorKind::kForce:
      return "fingertip force";
    case SensorKind::kDirection:
      return "fingertip direction";
    case SensorKind::kWrist:
      break;
  }
  return "wrist";
}

const recordings::Plan& plan_of(SensorKind kind) {
  static const recordings::Plan kForce = preset("biotac_linear_lstm");
  static const recordings::Plan kDirection = preset("biotac_direction");
  static const recordings::Plan kWrist = preset("ft_rnnob");
  return kind == SensorKind::kForce ? kForce : kind == SensorKind::kDirection ? kDirection : kWrist;
}

int input_place(SensorKind kind, const std::string& name) {
  if (kind == SensorKind::kWrist) return sensing::observer_input_index(name);
  const std::vector<std::string> columns = tactile_columns(kind);
  const auto end = columns.begin() + kTactileInputCount;
  const auto found = std::find(columns.begin(), end, name);
  return found == end ? -1 : static_cast<int>(found - columns.begin());
}

SensorFolder read_sensor_folder(const std::filesystem::path& folder) {
  if (!std::filesystem::is_directory(folder))
    throw std::runtime_error(folder.string() + ": is not a folder");
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (entry.is_regular_file() && (ends_with(name, ".csv") || ends_with(name, ".csv.gz")))
      files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());

  SensorFolder result;
  for (const std::filesystem::path& path : files) {
    const std::string name = std::filesystem::relative(path, folder).string();
    try {
      std::string nearest;  // missing columns of the closest kind
      bool fits = false;
      for (const SensorKind kind : kSensorsDataKinds) {
        const std::string missing = read_as(kind, path, name, result.recordings);
        fits = fits || missing.empty();
        if (nearest.empty() || missing.size() < nearest.size())
          nearest = missing + " of a recording of a " + name_of(kind);
      }
      if (!fits) result.unfit.push_back(name + ": lacks" + nearest);
    } catch (const std::exception& error) {
      result.damaged.push_back(error.what());
    }
  }
  return result;
}

SensorTrack make_track(const SensorRecording& recording) {
  return recording.kind == SensorKind::kWrist ? wrist_track(recording) : tactile_track(recording);
}

}  // namespace palpate::sensor_models
