// Shape sensing of the long soft bar through six poses, the hand following the scene.

#include <map>
#include <palpate/channels.hpp>
#include <thread>

#include "sim/scenes/scene.hpp"
#include "tools/common/interruption.hpp"
#include "tools/common/table.hpp"
#include "tools/lab/demo/demo.hpp"
#include "tools/lab/demo/shape_drawing.hpp"
#include "tools/lab/runs/live_run.hpp"
#include "tools/lab/scores/score.hpp"

namespace palpate::demo {
namespace {

constexpr const char* kStageSensingScene = "sim/scenes/bar_long_soft_six_poses.yaml";
constexpr const char* kStageSensingConfiguration = "rt/config/examples/bar_long_soft.yaml";
constexpr const char* kStageSensingLevels[] = {"none", "calibrated 1"};
constexpr double kSlack = 10;            // s; the scene ends the run
constexpr double kReplayPatience = 240;  // s
/// Bounds of the shape error over the poses, m.
struct Bars {
  double mean, largest;
};
// Reached are 0.4 and 1.1 mm.
constexpr Bars kWithoutModelError{1e-3, 2.5e-3};
// A half per cent of the bar's length alone, which nothing but a camera can measure, is 2.5 mm.
constexpr Bars kWithModelError{5e-3, 10e-3};

double motion_duration(const std::filesystem::path& scene) {
  const auto motion = scenes::read_scene(config::Node::load_file(scene.string())).motion;
  if (!motion) throw config::Error(scene.string() + ": has no motion");
  return motion->duration();
}

struct SensingRun {
  scores::ScoredRun scored;
  runs::RunFiles files;
  std::optional<log::RunLog> log;
};

void judge_sensing(scores::ScoredRun& run) {
  const scores::ErrorSummary error = run.shape->at_holds();
  const Bars& bars = run.mismatch == "none" ? kWithoutModelError : kWithModelError;
  const auto check = [&run](const char* what, double value, double bar) {
    if (value > bar)
      run.missed.push_back(std::string(what) + " shape error is above " +
                           common::number(1e3 * bar, 1) + " mm");
  };
  check("mean", error.mean, bars.mean);
  check("largest", error.maximum, bars.largest);
}

std::vector<std::string> joined(const std::vector<std::string>& a,
                                const std::vector<std::string>& b) {
  std::vector<std::string> all = a;
  all.insert(all.end(), b.begin(), b.end());
  return all;
}

SensingRun run_live_method(Demo& demo, const runs::Method& method, const runs::Mismatch& mismatch) {
  SensingRun run;
  run.scored.stage = "shape sensing, bar_long soft, six poses";
  run.scored.name = method.name;
  run.scored.mismatch = mismatch.name;
  runs::RunPlan plan;
  plan.name = "sensing " + method.name + " " + mismatch.name;
  plan.source.scene = demo.file(kStageSensingScene);
  plan.source.scene_overrides = mismatch.scene;
  plan.source.duration = motion_duration(plan.source.scene);
  plan.configuration = demo.file(kStageSensingConfiguration);
  plan.overrides = joined(mismatch.daemon, method.overrides);
  plan.duration = plan.source.duration + kSlack;
  common::Progress progress(++demo.begun, demo.runs,
                            "six poses, " + method.name + ", model error " + mismatch.name);
  try {
    run.files = runs::run_live(plan, demo.log_folder(plan.name), progress);
    run.log = log::read_run(run.files.control, run.files.housekeeping);
    scores::score_into(run.scored, *run.log, scores::gate_of(plan));
    scores::check_poses(run.scored, plan.source.scene);
    judge_sensing(run.scored);
    progress.finish(run.scored.missed.empty());
  } catch (const common::Interrupted&) {
    throw;
  } catch (const std::exception& error) {
    run.scored.failure = error.what();
  }
  return run;
}

/// Another method on the sensors that a live run has recorded.
struct Replay {
  scores::ScoredRun scored;
  std::filesystem::path output;
  const log::RunLog* live;
  std::unique_ptr<common::Process> process;
};

Replay start_replay(const Demo& demo, const SensingRun& live, const runs::Method& method,
                    const runs::Mismatch& mismatch) {
  Replay replay;
  replay.scored.stage = live.scored.stage;
  replay.scored.name = method.name;
  replay.scored.mismatch = mismatch.name;
  replay.live = &*live.log;
  const std::string name = "sensing " + method.name + " " + mismatch.name;
  const std::filesystem::path folder = demo.log_folder(name);
  std::filesystem::create_directories(folder);
  replay.output = folder / "replay.log";
  std::vector<std::string> command{(common::program_folder() / "palpate-replay").string(),
                                   live.files.control.string(),
                                   "--config",
                                   demo.file(kStageSensingConfiguration).string(),
                                   "--output",
                                   replay.output.string()};
  for (const std::string& setting : joined(mismatch.daemon, method.overrides)) {
    command.push_back("--set");
    command.push_back(setting);
  }
  replay.process =
      std::make_unique<common::Process>("palpate-replay", command, folder / "palpate-replay.txt");
  return replay;
}

void finish_replay(Replay& replay, common::Progress& progress) {
  const std::int64_t begin = bus::wall_clock_us();
  while (!replay.process->wait(0.05)) {
    common::throw_if_interrupted();
    const double elapsed = static_cast<double>(bus::wall_clock_us() - begin) * 1e-6;
    if (elapsed > kReplayPatience) throw runs::RunFailed("palpate-replay takes too long");
    progress.show(elapsed / kReplayPatience);
  }
  if (const int code = *replay.process->wait(0); code != 0)
    throw runs::RunFailed("palpate-replay ended with exit code " + std::to_string(code) + ":\n" +
                          common::tail(replay.process->output(), 15));
  log::RunLog log;
  log::LogReader reader;
  reader.collect(channel::kShape, log.shapes);
  reader.collect(channel::kShapeMesh, log.shape_chunks);
  reader.read(replay.output);
  log.truths = replay.live->truths;
  log.truth_chunks = replay.live->truth_chunks;
  log.truth_contacts = replay.live->truth_contacts;
  replay.scored.shape = scores::score_shape(log);
}

}  // namespace

int count_sensing(const Demo& demo) {
  const int methods =
      static_cast<int>(runs::read_methods(demo.file("tools/lab/studies/methods.yaml")).size());
  return methods * static_cast<int>(std::size(kStageSensingLevels));
}

void run_sensing(Demo& demo) {
  const std::vector<runs::Method> methods =
      runs::read_methods(demo.file("tools/lab/studies/methods.yaml"));
  std::vector<runs::Mismatch> levels;
  for (const char* level : kStageSensingLevels)
    levels.push_back(demo.mismatch(level, kStageSensingScene, kStageSensingConfiguration));

  std::vector<SensingRun> live;
  for (const runs::Mismatch& level : levels)
    live.push_back(run_live_method(demo, methods[0], level));

  // The rest is computation on logs: as many at a time as there are cores.
  std::vector<Replay> replays;
  for (std::size_t m = 1; m < methods.size(); ++m)
    for (std::size_t l = 0; l < levels.size(); ++l)
      if (live[l].log) replays.push_back(start_replay(demo, live[l], methods[m], levels[l]));
  for (SensingRun& run : live) demo.scored.push_back(run.scored);
  for (Replay& replay : replays) {
    common::Progress progress(
        ++demo.begun, demo.runs,
        "the same log, " + replay.scored.name + ", " + replay.scored.mismatch);
    try {
      finish_replay(replay, progress);
      progress.finish(true);
    } catch (const common::Interrupted&) {
      throw;
    } catch (const std::exception& error) {
      replay.scored.failure = error.what();
    }
    demo.scored.push_back(replay.scored);
  }
  draw_sensing(demo, live.empty() || !live.back().log ? nullptr : &*live.back().log);
}

}  // namespace palpate::demo
