#include "tools/lab/studies/sensing_recording.hpp"

#include <cmath>
#include <lcm/lcm-cpp.hpp>
#include <nlohmann/json.hpp>
#include <palpate/channels.hpp>
#include <set>

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

constexpr double kSettle = 0.5;  // s after the end of a scene's motion
constexpr double kSlack = 10;    // s
constexpr const char* kSensorLog = "sensors.log";
constexpr const char* kTruthLog = "truth.log";
constexpr const char* kFormat = "recording 2";  // changes with the retained contents of a run

/// The sender's clock, the second field of every message.
std::int64_t sent_at(const bus::LoggedEvent& event) {
  if (event.size < 16) return 0;
  std::int64_t utime = 0;
  for (int i = 8; i < 16; ++i) utime = utime << 8 | event.data[i];
  return utime;
}

/// Writes the sensors' messages, each at its simulated time of arrival: in lock-step the log's own
/// times are those of a possibly slow machine.
void keep_sensors(const fs::path& from, const fs::path& to) {
  static const std::set<std::string> kSensors{
      channel::kFtWrench,         channel::kImu,     channel::kRobotState, channel::kHandState,
      channel::kShapeObservation, channel::kBiotac0, channel::kBiotac1,    channel::kBiotac2,
      channel::kBiotac3,          channel::kBiotac4};
  bus::EventLogReader reader(from.string());
  lcm::LogFile writer(to.string(), "w");
  if (!writer.good()) throw runs::RunFailed(to.string() + " cannot be written");
  std::int64_t now = 0;
  while (const bus::LoggedEvent* event = reader.next()) {
    if (kSensors.count(event->channel) == 0) continue;
    if (event->channel == channel::kRobotState) now = std::max(now, sent_at(*event));
    if (now == 0) continue;
    lcm::LogEvent kept{};
    kept.timestamp = now;
    kept.channel = event->channel;
    kept.datalen = event->size;
    kept.data = const_cast<std::uint8_t*>(event->data);
    writer.writeEvent(&kept);
  }
}

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
  runs::RunPlan plan;
  plan.name = "recording";
  plan.source.scene = scene.scene;
  plan.source.scene_overrides = scene.scene_overrides;
  plan.source.duration = motion_duration(scene);
  plan.configuration = scene.configuration;
  plan.overrides = scene.daemon_overrides;
  plan.duration = plan.source.duration + kSlack;
  plan.settled = plan.duration;
  plan.lock_step = true;
  common::Progress progress(1, 1, "recording of " + scene.scene.filename().string());
  const runs::RunFiles files = runs::run_live(plan, folder, progress);
  progress.finish(true);
  keep_sensors(files.control, folder / kSensorLog);
  fs::rename(files.housekeeping, folder / kTruthLog);
  fs::remove(files.control);
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
