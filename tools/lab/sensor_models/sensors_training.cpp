#include "tools/lab/sensor_models/sensors_training.hpp"

#include <algorithm>
#include <fstream>
#include <sstream>

#include "rt/config/node.hpp"

namespace palpate::sensor_models {
namespace {

bool in_any(const std::vector<recordings::Interval>& intervals, double t) {
  return std::any_of(intervals.begin(), intervals.end(),
                     [t](const recordings::Interval& interval) { return interval.contains(t); });
}

bool same(const std::vector<recordings::Interval>& a, const std::vector<recordings::Interval>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& x, const auto& y) {
    return x.begin == y.begin && x.end == y.end;
  });
}

std::vector<recordings::Interval> intervals(const YAML::Node& ends) {
  std::vector<recordings::Interval> list;
  if (!ends.IsDefined()) return list;
  for (std::size_t i = 0; i + 1 < ends.size(); i += 2)
    list.push_back({ends[i].as<double>(), ends[i + 1].as<double>()});
  return list;
}

}  // namespace

bool SensorTraining::operator==(const SensorTraining& other) const {
  return all_parts == other.all_parts && is_stated == other.is_stated &&
         std::equal(
             files.begin(), files.end(), other.files.begin(), other.files.end(),
             [this](const File& a, const File& b) {
               return a.sha256 == b.sha256 &&
                      (all_parts || (same(a.validation, b.validation) && same(a.test, b.test)));
             });
}

const SensorTraining::File* SensorTraining::find(const SensorRecording& recording) const {
  for (const File& file : files)
    if (file.sha256 == recording.sha256) return &file;
  return nullptr;
}

SensorTraining training_of(const inference::ModelCard& card) {
  SensorTraining training;
  try {
    const YAML::Node& node = card.training;
    training.is_stated = node.IsMap() && node["data"].IsDefined();
    if (!training.is_stated) return training;
    training.all_parts = node["refit_on_all_parts"] && node["refit_on_all_parts"].as<bool>();
    for (const YAML::Node& file : node["data"])
      training.files.push_back({file["sha256"].as<std::string>(),
                                intervals(file["validation_seconds"]),
                                intervals(file["test_seconds"])});
  } catch (const YAML::Exception& error) {
    throw config::Error("card of " + card.name + ": training: " + error.what());
  }
  return training;
}

SensorTraining training_of(const recordings::DataPlan& plan, const std::filesystem::path& folder,
                           bool all_parts) {
  SensorTraining training;
  training.all_parts = all_parts;
  for (const recordings::RecordingPlan& entry : plan.recordings) {
    std::ifstream stream(folder / entry.file, std::ios::binary);
    if (!stream) continue;
    std::ostringstream bytes;
    bytes << stream.rdbuf();
    training.files.push_back({inference::sha256_of(bytes.str()), entry.validation, entry.test});
  }
  return training;
}

std::vector<bool> rows_to_learn(const SensorTraining& training, const SensorTrack& track) {
  std::vector<bool> rows(track.counts.size(), false);
  const SensorTraining::File* file = training.find(track.recording);
  if (file == nullptr) return rows;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const double t = track.time[static_cast<Eigen::Index>(k)];
    rows[k] = track.counts[k] &&
              (training.all_parts || !(in_any(file->validation, t) || in_any(file->test, t)));
  }
  return rows;
}

ScoredRows rows_to_score(const SensorTraining& training, const SensorTrack& track) {
  ScoredRows scored{track.counts, "unseen"};
  if (!training.is_stated) scored.origin = "training not stated";
  const SensorTraining::File* file = training.find(track.recording);
  if (file == nullptr) return scored;
  if (training.all_parts || file->test.empty()) {
    scored.origin = "trained on";
    return scored;
  }
  bool all = true;
  for (std::size_t k = 0; k < scored.rows.size(); ++k) {
    const bool test = in_any(file->test, track.time[static_cast<Eigen::Index>(k)]);
    all = all && test;
    scored.rows[k] = scored.rows[k] && test;
  }
  if (!all) scored.origin = "unseen blocks";
  return scored;
}

Eigen::MatrixXd wanted_rows(const Eigen::MatrixXd& rows, const std::vector<bool>& wanted) {
  Eigen::MatrixXd result(std::count(wanted.begin(), wanted.end(), true), rows.cols());
  Eigen::Index next = 0;
  for (std::size_t k = 0; k < wanted.size(); ++k)
    if (wanted[k]) result.row(next++) = rows.row(static_cast<Eigen::Index>(k));
  return result;
}

Eigen::MatrixXd stacked(const std::vector<Eigen::MatrixXd>& parts) {
  Eigen::Index count = 0;
  for (const Eigen::MatrixXd& part : parts) count += part.rows();
  Eigen::MatrixXd all(count, parts.empty() ? 0 : parts.front().cols());
  count = 0;
  for (const Eigen::MatrixXd& part : parts) {
    all.middleRows(count, part.rows()) = part;
    count += part.rows();
  }
  return all;
}

}  // namespace palpate::sensor_models
