#include "tools/lab/sensor_models/sensors.hpp"

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "tools/common/interruption.hpp"
#include "tools/common/output_files.hpp"
#include "tools/lab/scores/report.hpp"
#include "tools/lab/sensor_models/sensors_models.hpp"
#include "tools/lab/sensor_models/sensors_report.hpp"

namespace palpate::sensor_models {
namespace {

constexpr SensorKind kKinds[] = {SensorKind::kForce, SensorKind::kDirection, SensorKind::kWrist};

/// Methods that were fitted to the same rows.
struct FittedMethods {
  SensorTraining training;
  std::vector<SensorMethod> methods;
};

using Tracks = std::map<SensorKind, std::vector<SensorTrack>>;

Tracks make_tracks(const SensorFolder& folder, std::vector<std::string>& damaged) {
  Tracks tracks;
  damaged.insert(damaged.end(), folder.damaged.begin(), folder.damaged.end());
  for (const SensorRecording& recording : folder.recordings) {
    try {
      tracks[recording.kind].push_back(make_track(recording));
    } catch (const std::exception& error) {
      damaged.push_back(recording.name + ": " + error.what());
    }
  }
  return tracks;
}

/// Whether a file of `scored` is not in `known`.
bool has_new_file(const Tracks& scored, const Tracks& known) {
  std::set<std::string> hashes;
  for (const auto& [kind, tracks] : known)
    for (const SensorTrack& track : tracks) hashes.insert(track.recording.sha256);
  for (const auto& [kind, tracks] : scored)
    for (const SensorTrack& track : tracks)
      if (hashes.count(track.recording.sha256) == 0) return true;
  return false;
}

std::vector<SensorModelFile> models_of(const SensorsOptions& options, const Tracks& tracks,
                                       bool refit, std::ostream& out) {
  std::vector<SensorModelFile> models;
  for (const std::filesystem::path& path : options.models)
    models.push_back(read_sensor_model(path));
  if (!models.empty()) return models;
  const std::vector<std::string>& presets = default_sensor_models();
  for (std::size_t i = 0; i < presets.size(); ++i) {
    const SensorKind kind = kind_of_preset(presets[i]);
    if (tracks.count(kind) == 0) continue;
    const auto path =
        train_sensor_model(presets[i], {options.train, options.output / "models", refit},
                           static_cast<int>(i) + 1, static_cast<int>(presets.size()));
    if (path)
      models.push_back(read_sensor_model(*path));
    else
      out << presets[i] << ": not trained, its recordings are absent below "
          << options.train.string() << "\n";
  }
  return models;
}

/// Models and baselines of a kind, grouped by the rows they were fitted to, models first.
std::vector<FittedMethods> methods_of(SensorKind kind, const SensorsOptions& options,
                                      const std::vector<SensorModelFile>& models,
                                      const std::vector<SensorTrack>& known, bool refit,
                                      std::ostream& out) {
  const SensorTraining usual = training_of(plan_of(kind).data, options.train, refit);
  std::vector<FittedMethods> list;
  for (const SensorModelFile& model : models) {
    if (model.kind != kind) continue;
    SensorTraining training = model.training;
    if (!training.is_stated) {
      training = usual;
      training.is_stated = false;
    }
    auto found = std::find_if(list.begin(), list.end(), [&](const FittedMethods& entry) {
      return entry.training == training;
    });
    if (found == list.end()) found = list.insert(list.end(), {training, {}});
    std::optional<FingertipFrame> frame;
    if (kind == SensorKind::kDirection) frame = fit_frame(training, known);
    for (SensorMethod& method : make_methods(model, options.executor, frame))
      found->methods.push_back(std::move(method));
  }
  if (list.empty()) list.push_back({usual, {}});
  for (FittedMethods& entry : list) {
    const std::vector<SensorMethod> baselines = make_baselines(kind, entry.training, known);
    if (baselines.empty())
      out << name_of(kind)
          << ": no baselines, since the recordings to fit them to are absent below "
          << options.train.string() << "\n";
    entry.methods.insert(entry.methods.end(), baselines.begin(), baselines.end());
  }
  return list;
}

std::vector<SensorTrack> of_file(const std::vector<SensorTrack>& tracks, const std::string& file) {
  std::vector<SensorTrack> list;
  for (const SensorTrack& track : tracks)
    if (track.recording.file == file) list.push_back(track);
  return list;
}

}  // namespace

std::vector<SensorComparison> compare_sensor_folders(const SensorsOptions& options,
                                                     std::ostream& out,
                                                     std::vector<std::string>& damaged) {
  const SensorFolder folder = read_sensor_folder(options.data);
  if (options.verbose)
    for (const std::string& line : folder.unfit) out << line << "\n";
  const Tracks scored = make_tracks(folder, damaged);
  for (const std::string& line : damaged) out << "passed over: " << line << "\n";
  if (scored.empty())
    throw std::runtime_error(options.data.string() + ": no recording of a sensor that is scored (" +
                             std::to_string(folder.unfit.size()) +
                             " files of other columns; --verbose names what they lack)");
  std::vector<std::string> unused;
  const Tracks known = std::filesystem::is_directory(options.train)
                           ? make_tracks(read_sensor_folder(options.train), unused)
                           : Tracks{};
  // If the recordings are new, models may be trained on all their data; otherwise their test data
  // stay unseen.
  const bool refit = has_new_file(scored, known);

  const std::vector<SensorModelFile> models = models_of(options, scored, refit, out);
  std::vector<SensorComparison> comparisons;
  for (const SensorKind kind : kKinds) {
    if (scored.count(kind) == 0) continue;
    const std::vector<SensorTrack>& tracks = scored.at(kind);
    const auto found = known.find(kind);
    std::vector<std::string> files;
    for (const SensorTrack& track : tracks)
      if (files.empty() || files.back() != track.recording.file)
        files.push_back(track.recording.file);
    for (const FittedMethods& fitted :
         methods_of(kind, options, models,
                    found == known.end() ? std::vector<SensorTrack>{} : found->second, refit, out))
      for (const std::string& file : files) {
        common::throw_if_interrupted();
        if (fitted.methods.empty()) continue;
        SensorComparison comparison =
            compare_sensors(of_file(tracks, file), fitted.training, fitted.methods);
        if (!comparison.scores.empty()) comparisons.push_back(std::move(comparison));
      }
  }
  return comparisons;
}

int run_sensors(const SensorsOptions& options, std::ostream& out) {
  std::filesystem::create_directories(options.output);
  std::vector<std::string> damaged;
  const std::vector<SensorComparison> comparisons = compare_sensor_folders(options, out, damaged);
  if (comparisons.empty())
    throw std::runtime_error(options.data.string() + ": nothing could be scored");
  out << "scored: recordings below " << options.data.string() << "; fitted to: "
      << (options.models.empty() ? options.train.string() : "what the models' cards name")
      << "; executor: " << options.executor << "\n\n";
  print_sensors(comparisons, out);

  const std::filesystem::path csv = options.output / "sensors.csv";
  std::ofstream file(csv);
  write_sensors_csv(comparisons, file);
  if (!file.flush()) throw std::runtime_error(csv.string() + ": cannot be written");
  if (!options.json.empty()) {
    nlohmann::json json{{"version", PALPATE_VERSION},
                        {"executor", options.executor},
                        {"passed_over", damaged},
                        {"comparisons", nlohmann::json::array()}};
    for (const SensorComparison& comparison : comparisons)
      json["comparisons"].push_back(to_json(comparison));
    common::write_json(json, options.json);
  }
  const auto pictures = draw_sensors(comparisons, options.output);
  out << "wrote " << csv.string() << " and " << pictures.size() << " pictures next to it\n";
  return damaged.empty() ? 0 : 1;
}

SensorsCommand::SensorsCommand(CLI::App& app) {
  options_.output = "out/sensors";
  command_ = app.add_subcommand(
      "sensors",
      "every sensor model on every recording that fits it, with what it is compared with. A "
      "model "
      "is scored on rows that it was not trained on; where a recording has none it says so");
  command_->add_option("--data", options_.data,
                       "recordings to score, found by their columns (default: those of --train)");
  command_->add_option("--train", options_.train,
                       "recordings to fit to (default: PALPATE_DATA or ../shared/data)");
  command_->add_option("--model", options_.models,
                       "module of palpate-train, its card next to it (repeatable; default: the "
                       "presets, trained on --train)");
  command_->add_option("--output", options_.output, "folder for trained models, CSV and pictures")
      ->capture_default_str();
  command_->add_option("--json", options_.json, "write the scores to this file");
  command_->add_option("--executor", options_.executor, "what runs the models")
      ->check(CLI::IsMember({"compiled", "torch"}))
      ->capture_default_str();
  command_->add_flag("--verbose", options_.verbose, "name the columns that other files lack");
}

std::optional<int> SensorsCommand::run(const std::filesystem::path& recordings, std::ostream& out) {
  if (!command_->parsed()) return {};
  common::catch_interruptions();
  if (options_.train.empty()) options_.train = recordings;
  if (options_.data.empty()) options_.data = options_.train;
  return run_sensors(options_, out);
}

}  // namespace palpate::sensor_models
