#include "tools/lab/sensor_models/sensors_score.hpp"

#include <algorithm>

namespace palpate::sensor_models {
namespace {

std::vector<SensorTare> tares_of(SensorKind kind) {
  if (kind != SensorKind::kWrist) return {SensorTare::kNone};
  return {SensorTare::kRecording, SensorTare::kFirstSeconds};
}

Eigen::MatrixXd tared(Eigen::MatrixXd answers, const SensorTrack& track, SensorTare tare) {
  Eigen::Index rows = track.time.size();
  if (tare == SensorTare::kNone) return answers;
  if (tare == SensorTare::kFirstSeconds)
    rows = std::count_if(track.time.begin(), track.time.end(),
                         [](double t) { return t < kFirstSeconds; });
  const Eigen::RowVectorXd mean =
      (answers.topRows(rows) - track.truth.topRows(rows)).colwise().mean();
  return answers.rowwise() - mean;
}

/// Scored quantities of one recording.
struct Part {
  const SensorTrack* track;
  std::vector<bool> rows;
  Eigen::MatrixXd truth;
};

}  // namespace

std::string name_of(SensorTare tare) {
  switch (tare) {
    case SensorTare::kRecording:
      return "recording mean";
    case SensorTare::kFirstSeconds:
      return "first 2 s";
    case SensorTare::kNone:
      break;
  }
  return "";
}

SensorComparison compare_sensors(const std::vector<SensorTrack>& tracks,
                                 const SensorTraining& training,
                                 const std::vector<SensorMethod>& methods) {
  SensorComparison comparison;
  std::vector<Part> parts;
  for (const SensorTrack& track : tracks) {
    const ScoredRows scored = rows_to_score(training, track);
    if (std::count(scored.rows.begin(), scored.rows.end(), true) < 2) continue;
    parts.push_back({&track, scored.rows, wanted_rows(track.truth, scored.rows)});
    comparison.origin = scored.origin;
    comparison.recordings.push_back(track.recording.name);
  }
  if (parts.empty()) return comparison;
  comparison.kind = tracks.front().recording.kind;
  comparison.file = tracks.front().recording.file;
  const auto& groups = plan_of(comparison.kind).data.outputs;
  std::size_t largest = 0;
  std::vector<Eigen::MatrixXd> truths;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    truths.push_back(parts[i].truth);
    if (parts[i].truth.rows() > parts[largest].truth.rows()) largest = i;
  }
  const Eigen::MatrixXd truth = stacked(truths);
  comparison.time = wanted_rows(parts[largest].track->time, parts[largest].rows);
  comparison.truth = parts[largest].truth;

  for (const SensorMethod& method : methods) {
    std::vector<Eigen::MatrixXd> raw;
    for (const Part& part : parts) raw.push_back(method.answer(*part.track));
    comparison.methods.push_back(method.name);
    for (const SensorTare tare : tares_of(comparison.kind)) {
      std::vector<Eigen::MatrixXd> answers;
      for (std::size_t i = 0; i < parts.size(); ++i)
        answers.push_back(wanted_rows(tared(raw[i], *parts[i].track, tare), parts[i].rows));
      if (tare == tares_of(comparison.kind).front()) comparison.answers.push_back(answers[largest]);
      comparison.scores.push_back({method.name, method.is_model, "", tare,
                                   recordings::measure_errors(stacked(answers), truth, groups)});
      if (parts.size() == 1) continue;
      for (std::size_t i = 0; i < parts.size(); ++i)
        comparison.scores.push_back(
            {method.name, method.is_model, comparison.recordings[i], tare,
             recordings::measure_errors(answers[i], parts[i].truth, groups)});
    }
  }
  return comparison;
}

}  // namespace palpate::sensor_models
