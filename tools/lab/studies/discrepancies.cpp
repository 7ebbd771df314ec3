#include "tools/lab/studies/discrepancies.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <palpate/channels.hpp>
#include <stdexcept>

#include "rt/config/node.hpp"
#include "rt/registry/frames.hpp"
#include "sim/scenes/scene.hpp"
#include "tools/common/interruption.hpp"
#include "tools/common/output_files.hpp"
#include "tools/common/process.hpp"
#include "tools/common/table.hpp"
#include "tools/lab/studies/discrepancy_intervals.hpp"
#include "tools/lab/studies/discrepancy_ranking.hpp"
#include "tools/lab/studies/discrepancy_score.hpp"
#include "tools/lab/studies/sensing_recording.hpp"
#include "tools/lab/studies/study_hash.hpp"
#include "tools/lab/studies/study_progress.hpp"
#include "tools/lab/studies/study_scheduler.hpp"

namespace palpate::studies {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr const char* kPlan = "tools/lab/studies/discrepancies.yaml";
constexpr const char* kReport = "tools/lab/report/report_discrepancies";
constexpr double kWorldPatience = 1500;  // s, of a replay, and of a simulation besides its duration
constexpr double kWorldSlowness = 30;    // times real time, at most
// A long world is read at fewer instants, for the sake of memory.
constexpr double kLong = 120, kPeriod = 0.1;  // s
constexpr double kEstimatePeriod = 0.01;      // s

bool is_long(const DiscrepancyWorld& world) { return world.duration > kLong; }

double patience_of(const DiscrepancyWorld& world) {
  return kWorldPatience + kWorldSlowness * std::max(0.0, world.duration - kLong);
}

SensingScene scene_of(const DiscrepancyWorld& world) {
  return {world.scene, world.scene_overrides, world.configuration,
          {},          world.duration,        is_long(world) ? kPeriod : 0};
}

std::vector<std::string> hashes_of_programs() {
  std::vector<std::string> hashes;
  for (const char* program : {"palpate-sim", "palpate-replay", "palpate-evaluate"})
    hashes.push_back(hash_of_file(common::program_folder() / program));
  return hashes;
}

std::string hash_of(const DiscrepancyWorld& world, const std::vector<std::string>& programs) {
  StudyJob job;
  job.kind = "discrepancy " + world.kind;
  job.scene = world.scene;
  job.scene_overrides = world.scene_overrides;
  job.configuration = world.configuration;
  job.daemon_overrides = world.daemon_overrides;
  job.duration = world.duration;
  return hash_of_inputs(job, programs);
}

/// Replays the recording by an estimator: shapes, estimates and what they report.
void replay_world(const DiscrepancyWorld& world, const SensingRecording& recording,
                  const std::vector<std::string>& overrides, const fs::path& folder,
                  log::RunLog& log) {
  log.shapes.clear();
  log.shape_chunks.clear();
  log.estimates.clear();
  log.health.clear();
  const std::int64_t shape_period = is_long(world) ? std::llround(1e6 * kPeriod) : 0,
                     estimate_period = is_long(world) ? std::llround(1e6 * kEstimatePeriod) : 0;
  log::LogReader reader(log::LogClock::kSent);
  reader.collect(channel::kShape, log.shapes, shape_period);
  reader.collect(channel::kShapeMesh, log.shape_chunks);
  reader.collect(channel::kEstimate, log.estimates, estimate_period);
  reader.collect(channel::kUnknownContact, log.unknown_contacts);
  reader.collect(channel::kDiscrepancy, log.discrepancies);
  reader.collect(channel::kHealth, log.health);
  replay(scene_of(world), recording, overrides, folder, patience_of(world), reader);
}

Json description_of(const DiscrepancyWorld& world) {
  Json parameters = Json::array();
  for (const runs::DrawnValue& value : world.drawn)
    parameters.push_back(
        {{"parameter", value.parameter}, {"unit", value.unit}, {"value", value.value}});
  const int cause = cause_of(world.kind);
  return {{"version", PALPATE_VERSION},
          {"name", world.name},
          {"kind", world.kind},
          {"object", world.object},
          {"cause", cause == discrepancy_t::CAUSE_UNKNOWN ? Json() : Json(cause_name(cause))},
          {"parameters", parameters}};
}

/// Simulates the world unless its recording exists, replays it by pose alone, unless it is long,
/// and by the method, and leaves result.json.
void run_world(const DiscrepancyWorld& world, const std::string& inputs_hash,
               const fs::path& folder) {
  fs::create_directories(folder);
  SensingRecording recording = record_sensing(scene_of(world), folder / "recording");
  log::RunLog log;
  log.truths = std::move(recording.truth.truths);
  log.truth_chunks = std::move(recording.truth.truth_chunks);
  log.truth_contacts = std::move(recording.truth.truth_contacts);
  const scenes::Scene scene =
      scenes::read_scene(config::Node::load_file(world.scene.string(), world.scene_overrides));
  const math::Pose X_OP =
      registry::read_frames(
          config::Node::load_file(world.configuration.string(), world.daemon_overrides))
          .X_WO.inverse() *
      scene.X_WO;

  std::vector<scores::ShapeErrorSample> pose_alone;
  if (!is_long(world)) {  // a long world counts false reports
    std::vector<std::string> overrides = world.daemon_overrides;
    overrides.emplace_back("estimation={component: pose_driven}");
    replay_world(world, recording, overrides, folder, log);
    pose_alone = shape_errors(log, X_OP);
  }
  replay_world(world, recording, world.daemon_overrides, folder, log);

  const DiscrepancyScore score = score_discrepancy(world, log, pose_alone, X_OP);
  const std::int64_t start = log.truths.front().utime;
  Json result = description_of(world);
  result["inputs_hash"] = inputs_hash;
  result["score"] = to_json(score, start);
  if (world.kind == "none")
    result["intervals"] = to_json(score_intervals(log, X_OP, scene.plant.young_modulus,
                                                  start + std::llround(1e6 * world.begin)));
  common::write_json(result, folder / "result.json.part");
  fs::rename(folder / "result.json.part", folder / "result.json");
}

void print_list(const std::vector<DiscrepancyWorld>& worlds, std::ostream& out) {
  common::Table table({"world", "s", "onset s"});
  for (const DiscrepancyWorld& world : worlds)
    table.add({world.name, common::number(world.duration, 1),
               world.obstacle ? "at contact" : common::number(world.onset, 1)});
  table.print(out);
}

}  // namespace

struct DiscrepanciesCommand::Options {
  fs::path plan;
  fs::path output = "out/discrepancies";
  fs::path json;
  WorldSelection selection;
  int workers = 2;
  bool list = false, discards = false;
  std::string world;
};

namespace {

/// The program and options that make the same worlds again.
std::vector<std::string> command_of(const WorldSelection& selection, const fs::path& plan,
                                    const fs::path& root, const fs::path& folder) {
  std::vector<std::string> command{fs::read_symlink("/proc/self/exe").string(),
                                   "--root",
                                   root.string(),
                                   "discrepancies",
                                   "--plan",
                                   plan.string(),
                                   "--worlds",
                                   std::to_string(selection.count),
                                   "--seed",
                                   std::to_string(selection.seed),
                                   "--set",
                                   selection.set,
                                   "--minutes",
                                   common::formatted("%.9g", selection.minutes),
                                   "--output",
                                   folder.string()};
  if (!selection.errors.empty()) command.insert(command.end(), {"--errors", selection.errors});
  if (!selection.kind.empty()) command.insert(command.end(), {"--kind", selection.kind});
  return command;
}

}  // namespace

DiscrepanciesCommand::DiscrepanciesCommand(CLI::App& app)
    : options_(std::make_unique<Options>()),
      command_(app.add_subcommand(
          "discrepancies",
          "random worlds that palpated's model does not describe: tables, walls, a sprung or "
          "shifted clamp, uneven stiffness, slip, weight; whether the estimator reports them.\n"
          "What has been run with the same inputs and programs is not run again; Ctrl-C ends it, "
          "and the same command resumes where it stopped.")) {
  Options& o = *options_;
  command_->add_option("--plan", o.plan, std::string("kinds and objects (default: ") + kPlan + ")")
      ->check(CLI::ExistingFile);
  command_->add_option("--worlds", o.selection.count, "number of worlds")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command_->add_option("--seed", o.selection.seed, "seed of the worlds")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command_
      ->add_option("--set", o.selection.set,
                   "scoring or tuning: their objects and random numbers differ")
      ->capture_default_str();
  command_->add_option("--errors", o.selection.errors,
                       "distribution of the model errors besides, or none (default: the plan's)");
  command_->add_option("--kind", o.selection.kind,
                       "kind of all worlds (default: each by its share)");
  command_
      ->add_option("--minutes", o.selection.minutes,
                   "least duration of the worlds of the kind none, for false reports in free air")
      ->check(CLI::Range(0.0, 60.0));
  command_
      ->add_option("--output", o.output, "folder of recordings and results, about 30 MB a world")
      ->capture_default_str();
  command_->add_flag("--discard", o.discards, "remove the recording of a world once it is scored");
  command_->add_option(
      "--json", o.json,
      "file for all results, tables and goals; a page is made next to it (default: "
      "discrepancies.json in the output folder)");
  command_->add_option("--jobs", o.workers, "worlds side by side")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  command_->add_flag("--list", o.list, "list of the worlds; nothing is run");
  command_->add_option("--world", o.world, "name of a single world, run in this process");
}

DiscrepanciesCommand::~DiscrepanciesCommand() = default;

std::optional<int> DiscrepanciesCommand::run(const fs::path& root, std::ostream& out) {
  if (!command_->parsed()) return std::nullopt;
  const Options& o = *options_;
  const fs::path plan_file = fs::absolute(o.plan.empty() ? root / kPlan : o.plan),
                 folder = fs::absolute(o.output);
  const std::vector<DiscrepancyWorld> worlds = make_worlds(
      read_discrepancy_plan(plan_file, fs::absolute(root)), o.selection, fs::absolute(root));
  if (o.list) {
    print_list(worlds, out);
    return 0;
  }
  common::catch_interruptions();
  const std::vector<std::string> programs = hashes_of_programs();
  std::vector<Task> tasks;
  for (const DiscrepancyWorld& world : worlds) {
    if (o.world == world.name) {
      run_world(world, hash_of(world, programs), folder / world.name);
      if (o.discards) fs::remove_all(folder / world.name / "recording");
      return 0;
    }
    Task task{world.name, command_of(o.selection, plan_file, fs::absolute(root), folder),
              folder / world.name, hash_of(world, programs)};
    task.command.insert(task.command.end(), {"--world", world.name});
    if (o.discards) task.command.emplace_back("--discard");
    tasks.push_back(std::move(task));
  }
  if (!o.world.empty()) throw std::invalid_argument("no world is called " + o.world);

  ScheduleDisplay display;
  SchedulerOptions options;
  options.workers = o.workers;
  for (const DiscrepancyWorld& world : worlds)
    options.patience = std::max(options.patience, 3 * patience_of(world));
  options.show = [&display](const ScheduleStatus& status) { display.show(status); };
  std::vector<Json> results;
  std::vector<std::string> failures;
  const std::vector<TaskOutcome> outcomes = run_tasks(tasks, options);
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    if (outcomes[i].state == TaskOutcome::State::kFailed) {
      failures.push_back(outcomes[i].name + ": " + outcomes[i].failure);
      continue;
    }
    std::ifstream in(tasks[i].folder / "result.json");
    results.push_back(Json::parse(in));
  }
  const fs::path file = o.json.empty() ? folder / "discrepancies.json" : fs::absolute(o.json);
  common::write_json({{"version", PALPATE_VERSION},
                      {"set", o.selection.set},
                      {"seed", o.selection.seed},
                      {"failures", failures},
                      {"worlds", results}},
                     file);
  for (const std::string& failure : failures) out << "FAILED: " << failure << '\n';
  out << common::run_python(kReport, {file.string()});
  return failures.empty() ? 0 : 1;
}

}  // namespace palpate::studies
