#include "tools/recordings/data_set.hpp"

#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "tools/recordings/recording_table.hpp"
#include "tools/recordings/wrist_data.hpp"

namespace palpate::recordings {
namespace {

std::string hash_of_file(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << stream.rdbuf();
  if (!stream) throw std::runtime_error(path + ": cannot be read");
  return inference::sha256_of(bytes.str());
}

std::vector<inference::Channel> channels(const std::vector<ColumnGroup>& groups) {
  std::vector<inference::Channel> list;
  for (const ColumnGroup& group : groups)
    for (const std::string& column : group.columns) list.push_back({column, group.unit});
  return list;
}

bool in_any(const std::vector<Interval>& intervals, double t) {
  for (const Interval& interval : intervals)
    if (interval.contains(t)) return true;
  return false;
}

std::string find_file(const std::vector<std::string>& folders, const std::string& file) {
  for (const std::string& folder : folders)
    if (std::filesystem::exists(folder + "/" + file)) return folder + "/" + file;
  std::string where;
  for (const std::string& folder : folders) where += " " + folder;
  throw std::runtime_error(file + ": not found below" + where);
}

/// Split by time, or by the recording's `number` in its file; every row counts.
Recording begin_recording(const Table& table, const RecordingPlan& plan, int number) {
  const bool validates =
      plan.validate_every > 0 && number % plan.validate_every == plan.validate_every - 1;
  Recording recording;
  recording.name = table.name;
  recording.time = table.time;
  for (const double t : table.time)
    recording.parts.push_back(in_any(plan.test, t)                      ? Part::kTest
                              : validates || in_any(plan.validation, t) ? Part::kValidation
                                                                        : Part::kTraining);
  recording.counts.assign(recording.parts.size(), true);
  return recording;
}

/// Means of the first `tare` seconds are subtracted from all columns, except from the outputs if
/// disabled.
void load_columns(const DataPlan& plan, const RecordingPlan& entry, const std::string& path,
                  DataSet& data) {
  std::vector<std::string> columns = columns_of(plan.inputs);
  const auto inputs = static_cast<Eigen::Index>(columns.size());
  const std::vector<std::string> output_columns = columns_of(plan.outputs);
  const auto outputs = static_cast<Eigen::Index>(output_columns.size());
  columns.insert(columns.end(), output_columns.begin(), output_columns.end());
  if (!plan.contact_column.empty()) columns.push_back(plan.contact_column);

  int number = 0;
  for (const Table& raw : read_tables(path, plan.time, columns, entry.column)) {
    Table table = resample(raw, plan.rate, plan.average);
    if (plan.tare > 0) {
      Eigen::Index rows = 0;
      while (rows < raw.time.size() && raw.time[rows] < plan.tare) ++rows;
      Eigen::RowVectorXd mean = raw.rows.topRows(rows).colwise().mean();
      if (!plan.tare_outputs) mean.segment(inputs, outputs).setZero();
      table.rows.rowwise() -= mean;
    }
    Recording recording = begin_recording(table, entry, number++);
    recording.inputs = table.rows.leftCols(inputs);
    recording.outputs = table.rows.middleCols(inputs, outputs);
    if (!plan.contact_column.empty())
      for (std::size_t k = 0; k < recording.counts.size(); ++k)
        recording.counts[k] =
            table.rows(static_cast<Eigen::Index>(k), inputs + outputs) > plan.contact_threshold;
    data.recordings.push_back(std::move(recording));
  }
}

}  // namespace

DataSet load_data(const DataPlan& plan, const std::vector<std::string>& folders) {
  DataSet data;
  data.inputs = channels(plan.inputs);
  data.outputs = channels(plan.outputs);
  std::vector<WristRecording> wrists;
  for (const RecordingPlan& entry : plan.recordings) {
    const std::string path = find_file(folders, entry.file);
    if (!plan.is_wrist) {
      load_columns(plan, entry, path, data);
    } else {
      int number = 0;
      for (const Table& raw :
           read_tables(path, plan.time, wrist_columns(plan.wrist), entry.column)) {
        wrists.push_back(load_wrist(plan, raw));
        Table table;
        table.name = raw.name;
        table.time = wrists.back().time;
        data.recordings.push_back(begin_recording(table, entry, number++));
      }
    }
    data.files.push_back({entry.file, hash_of_file(path)});
  }
  if (plan.is_wrist) finish_wrists(plan, wrists, data);
  return data;
}

Eigen::MatrixXd gather(const DataSet& data, const std::vector<Eigen::MatrixXd>& of_recordings,
                       Part part) {
  Eigen::Index count = 0;
  for (const Recording& recording : data.recordings)
    for (std::size_t k = 0; k < recording.parts.size(); ++k)
      count += recording.parts[k] == part && recording.counts[k];
  Eigen::MatrixXd rows(count, of_recordings.front().cols());
  Eigen::Index row = 0;
  for (std::size_t r = 0; r < data.recordings.size(); ++r) {
    const Recording& recording = data.recordings[r];
    for (std::size_t k = 0; k < recording.parts.size(); ++k)
      if (recording.parts[k] == part && recording.counts[k])
        rows.row(row++) = of_recordings[r].row(static_cast<Eigen::Index>(k));
  }
  return rows;
}

std::vector<Eigen::MatrixXd> inputs_of(const DataSet& data) {
  std::vector<Eigen::MatrixXd> list;
  for (const Recording& recording : data.recordings) list.push_back(recording.inputs);
  return list;
}

std::vector<Eigen::MatrixXd> outputs_of(const DataSet& data) {
  std::vector<Eigen::MatrixXd> list;
  for (const Recording& recording : data.recordings) list.push_back(recording.outputs);
  return list;
}

}  // namespace palpate::recordings
