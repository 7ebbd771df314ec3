#include "tools/lab/studies/sensing_recording.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "rt/config/node.hpp"
#include "sim/scenes/scene.hpp"
#include "tools/common/output_files.hpp"
#include "tools/lab/runs/live_run.hpp"
#include "tools/lab/scores/report.hpp"
#include "tools/lab/studies/study_hash.hpp"
#include "tools/lab/studies/study_scheduler.hpp"

namespace palpate::studies {
namespace {

namespace fs = std::filesystem;

constexpr double kSettle = 0.5;                    // s after the end of a scene's motion
constexpr double kPatience = 300, kSlowness = 30;  // s, of a recording; s per simulated second
constexpr const char* kSensorLog = "sensors.log";
constexpr const char* kTruthLog = "truth.log";
constexpr const char* kFormat = "recording 3";  // changes with the retained contents of a run

double motion_duration(const SensingScene& scene) {
  if (scene.duration > 0) return scene.duration;
  const auto motion =
      scenes::read_scene(config::Node::load_file(scene.scene.string(), scene.scene_overrides))
          .motion;
  if (!motion) throw config::Error(scene.scene.string() + ": has no motion");
  return motion->duration() + kSettle;
}

}  // namespace

std::string hash_of_recording(const SensingScene& scene) {
  StudyJob job;
  job.kind = "recording";
  job.scene = scene.scene;
  job.scene_overrides = scene.scene_overrides;
  job.configuration = scene.configuration;
  job.daemon_overrides = scene.daemon_overrides;
  job.duration = scene.duration;
  return hash_of_inputs(job, {kFormat, hash_of_file(common::program_folder() / "palpate-sim")});
}

SensingRecording read_recording(const SensingScene& scene, const fs::path& folder) {
  if (!has_result({"", {}, folder, hash_of_recording(scene)}))
    throw runs::RunFailed(folder.string() + " holds no recording of this scene");
  const fs::path sensors = folder / kSensorLog;
  return {sensors, log::read_run(sensors, folder / kTruthLog, log::LogClock::kSent,
                                 std::llround(1e6 * scene.period))};
}

SensingRecording record_sensing(const SensingScene& scene, const fs::path& folder) {
  const std::string hash = hash_of_recording(scene);
  if (has_result({"", {}, folder, hash})) return read_recording(scene, folder);
  fs::create_directories(folder);
  fs::remove(folder / "result.json");
  const fs::path said = folder / "palpate-sim.txt";
  const double duration = motion_duration(scene);
  std::vector<std::string> command{(common::program_folder() / "palpate-sim").string(),
                                   scene.scene.string(),
                                   "--record",
                                   folder.string(),
                                   "--duration",
                                   common::formatted("%.9g", duration)};
  for (const std::string& setting : scene.scene_overrides) {
    command.push_back("--set");
    command.push_back(setting);
  }
  const int code = common::run_to_end(command, said, kPatience + kSlowness * duration);
  if (code != 0)
    throw runs::RunFailed("palpate-sim, exit code " + std::to_string(code) + ":\n" +
                          common::tail(said, 8));
  common::write_json({{"inputs_hash", hash}, {"version", PALPATE_VERSION}}, folder / "result.json");
  return read_recording(scene, folder);
}

void replay(const SensingScene& scene, const SensingRecording& recording,
            const std::vector<std::string>& overrides, const fs::path& folder, double patience,
            log::LogReader& reader) {
  const fs::path replayed = folder / "replay.log", said = folder / "palpate-replay.txt";
  std::vector<std::string> command{(common::program_folder() / "palpate-replay").string(),
                                   recording.sensors.string(),
                                   "--start",
                                   "--config",
                                   scene.configuration.string(),
                                   "--output",
                                   replayed.string()};
  for (const std::vector<std::string>* settings : {&scene.daemon_overrides, &overrides})
    for (const std::string& setting : *settings) {
      command.push_back("--set");
      command.push_back(setting);
    }
  const int code = common::run_to_end(command, said, patience);
  if (code != 0)
    throw runs::RunFailed("palpate-replay, exit code " + std::to_string(code) + ":\n" +
                          common::tail(said, 8));
  reader.read(replayed);
  fs::remove(replayed);
}

}  // namespace palpate::studies
