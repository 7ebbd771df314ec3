#include "tools/evaluate/sensing_recording.hpp"

#include <fstream>
#include <lcm/lcm-cpp.hpp>
#include <set>
#include <sstream>

#include "rt/config/node.hpp"
#include "sim/scenes/scene.hpp"
#include "tools/evaluate/live_run.hpp"
#include "tools/evaluate/shape_score.hpp"

namespace palpate::evaluate {
namespace {

namespace fs = std::filesystem;

constexpr double kSettle = 0.5;  // s after the end of a scene's motion
constexpr double kSlack = 10;    // s

/// The sender's clock, the second field of every message.
std::int64_t sent_at(const bus::LoggedEvent& event) {
  if (event.size < 16) return 0;
  std::int64_t utime = 0;
  for (int i = 8; i < 16; ++i) utime = utime << 8 | event.data[i];
  return utime;
}

/// Writes what comes from sensors, each at the simulator's time when it came: in lock-step the
/// log's own times are those of a machine that may be slow.
void keep_sensors(const fs::path& from, const fs::path& to) {
  static const std::set<std::string> kSensors{
      "FT_WRENCH", "IMU",      "ROBOT_STATE", "HAND_STATE", "SHAPE_OBSERVATION",
      "BIOTAC_0",  "BIOTAC_1", "BIOTAC_2",    "BIOTAC_3",   "BIOTAC_4"};
  bus::EventLogReader reader(from.string());
  lcm::LogFile writer(to.string(), "w");
  if (!writer.good()) throw RunFailed(to.string() + " cannot be written");
  std::int64_t now = 0;
  while (const bus::LoggedEvent* event = reader.next()) {
    if (kSensors.count(event->channel) == 0) continue;
    if (event->channel == "ROBOT_STATE") now = std::max(now, sent_at(*event));
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

std::string describe(const SensingScene& scene) {
  std::string text = scene.scene.string() + '\n' + scene.configuration.string() + '\n';
  for (const std::string& setting : scene.scene_overrides) text += setting + '\n';
  for (const std::string& setting : scene.daemon_overrides) text += setting + '\n';
  return text;
}

}  // namespace

SensingRecording record_sensing(const SensingScene& scene, const fs::path& folder) {
  SensingRecording recording;
  recording.sensors = folder / "sensors.log";
  const fs::path truth = folder / "truth.log", about = folder / "recording.txt";
  std::stringstream known;
  known << std::ifstream(about).rdbuf();
  if (known.str() != describe(scene)) {
    fs::create_directories(folder);
    RunPlan plan;
    plan.name = "recording";
    plan.source.scene = scene.scene;
    plan.source.scene_overrides = scene.scene_overrides;
    plan.source.duration = motion_duration(scene);
    plan.configuration = scene.configuration;
    plan.overrides = scene.daemon_overrides;
    plan.duration = plan.source.duration + kSlack;
    plan.settled = plan.duration;
    plan.lock_step = true;
    Progress progress(1, 1, "recording of " + scene.scene.filename().string());
    const RunFiles files = run_live(plan, folder, progress);
    progress.finish(true);
    keep_sensors(files.control, recording.sensors);
    fs::rename(files.housekeeping, truth);
    fs::remove(files.control);
    std::ofstream(about) << describe(scene);
  }
  recording.truth = read_run(recording.sensors, truth, LogClock::kSent);
  return recording;
}

double replay_error(const fs::path& replayed, const SensingRecording& recording) {
  RunLog log;
  LogReader reader(LogClock::kSent);
  reader.collect("SHAPE", log.shapes);
  reader.collect("SHAPE_MESH", log.shape_chunks);
  reader.read(replayed);
  log.truths = recording.truth.truths;
  log.truth_chunks = recording.truth.truth_chunks;
  log.truth_contacts = recording.truth.truth_contacts;
  return score_shape(log).at_holds().mean;
}

std::vector<std::string> replay_command(const SensingScene& scene,
                                        const SensingRecording& recording,
                                        const std::vector<std::string>& overrides,
                                        const fs::path& output) {
  std::vector<std::string> command{(program_folder() / "palpate-replay").string(),
                                   recording.sensors.string(),
                                   "--start",
                                   "--config",
                                   scene.configuration.string(),
                                   "--output",
                                   output.string()};
  for (const std::vector<std::string>* settings : {&scene.daemon_overrides, &overrides})
    for (const std::string& setting : *settings) {
      command.push_back("--set");
      command.push_back(setting);
    }
  return command;
}

}  // namespace palpate::evaluate
