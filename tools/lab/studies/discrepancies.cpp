#include "tools/lab/studies/discrepancies.hpp"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <palpate/channels.hpp>
#include <stdexcept>

#include "rt/config/node.hpp"
#include "rt/registry/frames.hpp"
#include "sim/scenes/scene.hpp"
#include "tools/common/bootstrap.hpp"
#include "tools/common/interruption.hpp"
#include "tools/common/output_files.hpp"
#include "tools/common/process.hpp"
#include "tools/common/table.hpp"
#include "tools/lab/studies/discrepancy_score.hpp"
#include "tools/lab/studies/sensing_recording.hpp"
#include "tools/lab/studies/study_hash.hpp"
#include "tools/lab/studies/study_progress.hpp"
#include "tools/lab/studies/study_scheduler.hpp"
#include "tools/lab/studies/study_tables.hpp"

namespace palpate::studies {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr double kReplayPatience = 1500;  // s
constexpr const char* kPlan = "tools/lab/studies/discrepancies.yaml";

SensingScene scene_of(const DiscrepancyWorld& world) {
  return {world.scene, world.scene_overrides, world.configuration, {}, world.duration};
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

/// Simulates the world unless its recording exists, replays it and leaves result.json.
void run_world(const DiscrepancyWorld& world, const std::string& inputs_hash,
               const fs::path& folder) {
  fs::create_directories(folder);
  SensingRecording recording = record_sensing(scene_of(world), folder / "recording");
  log::RunLog log;
  log.truths = std::move(recording.truth.truths);
  log.truth_chunks = std::move(recording.truth.truth_chunks);
  log.truth_contacts = std::move(recording.truth.truth_contacts);
  log::LogReader reader(log::LogClock::kSent);
  reader.collect(channel::kShape, log.shapes);
  reader.collect(channel::kShapeMesh, log.shape_chunks);
  reader.collect(channel::kEstimate, log.estimates);
  reader.collect(channel::kHealth, log.health);
  replay(scene_of(world), recording, world.daemon_overrides, folder, kReplayPatience, reader);

  const config::Node scene = config::Node::load_file(world.scene.string(), world.scene_overrides),
                     configuration = config::Node::load_file(world.configuration.string(),
                                                             world.daemon_overrides);
  const math::Pose X_OP =
      registry::read_frames(configuration).X_WO.inverse() * scenes::read_scene(scene).X_WO;
  Json result{{"inputs_hash", inputs_hash}, {"version", PALPATE_VERSION},
              {"name", world.name},         {"kind", world.kind},
              {"object", world.object},     {"score", to_json(score_discrepancy(world, log, X_OP))},
              {"parameters", Json::array()}};
  for (const runs::DrawnValue& value : world.drawn)
    result["parameters"].push_back(
        {{"parameter", value.parameter}, {"unit", value.unit}, {"value", value.value}});
  common::write_json(result, folder / "result.json.part");
  fs::rename(folder / "result.json.part", folder / "result.json");
}

/// Numbers of the scores of one kind.
std::vector<double> numbers(const std::vector<Json>& scores, const char* key,
                            const char* since = nullptr) {
  std::vector<double> values;
  for (const Json& score : scores) {
    if (!score[key].is_number() || (since != nullptr && !score[since].is_number())) continue;
    const double from = since == nullptr ? 0 : score[since].get<double>();
    values.push_back(score[key].get<double>() - from);
  }
  return values;
}

long count(const std::vector<Json>& scores, const char* key) {
  return static_cast<long>(numbers(scores, key).size());
}

std::vector<std::string> row_of(const std::string& kind, const std::vector<Json>& scores) {
  const auto all = std::to_string(scores.size());
  const auto falsely = std::count_if(scores.begin(), scores.end(), [](const Json& score) {
    return score["false_report"].get<bool>();
  });
  const auto unreported = std::count_if(scores.begin(), scores.end(), [](const Json& score) {
    return score["largest_error_passed_s"].is_number() && !score["reported_s"].is_number();
  });
  return {kind,
          all,
          std::to_string(count(scores, "largest_error_passed_s")),
          spread(numbers(scores, "largest_error_mm"), 1, true),
          std::to_string(count(scores, "reported_s")),
          spread(numbers(scores, "reported_s", "largest_error_passed_s"), 2, true),
          std::to_string(unreported),
          std::to_string(falsely),
          spread(numbers(scores, "covered_while_reported_percent"), 0, true, true),
          spread(numbers(scores, "covered_while_wrong_and_unreported_percent"), 0, true, true),
          spread(numbers(scores, "recovered_s"), 1, true)};
}

ReportTable table_of(const std::vector<Json>& results) {
  ReportTable table{{"discrepancy", "worlds", "error passes 3 mm in", "largest error mm",
                     "reported in", "s after 3 mm", "passes 3 mm unreported", "reported falsely",
                     "nodes in 95 % ball, reported %", "unreported above 3 mm %",
                     "s to below 3 mm after the end"},
                    {}};
  std::vector<std::string> kinds;
  std::vector<Json> all;
  for (const Json& result : results) {
    all.push_back(result["score"]);
    const auto kind = result["kind"].get<std::string>();
    if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) kinds.push_back(kind);
  }
  for (const std::string& kind : kinds) {
    std::vector<Json> scores;
    for (const Json& result : results)
      if (result["kind"] == kind) scores.push_back(result["score"]);
    table.rows.push_back(row_of(kind, scores));
  }
  if (!all.empty()) table.rows.push_back(row_of("all", all));
  return table;
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
  std::string set = "scoring";
  std::string errors;  // empty: the plan's
  int worlds = 100;
  int seed = 1;
  int workers = 2;
  bool list = false;
  std::string world;
};

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
  command_->add_option("--worlds", o.worlds, "number of worlds")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command_->add_option("--seed", o.seed, "seed of the worlds")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command_->add_option("--set", o.set, "scoring or tuning: their objects and random numbers differ")
      ->capture_default_str();
  command_->add_option("--errors", o.errors,
                       "distribution of the model errors besides, or none (default: the plan's)");
  command_
      ->add_option("--output", o.output, "folder of recordings and results, about 30 MB a world")
      ->capture_default_str();
  command_->add_option("--json", o.json, "file for the table and all results");
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
  const std::vector<DiscrepancyWorld> worlds =
      make_worlds(read_discrepancy_plan(plan_file, fs::absolute(root)), o.set, o.worlds, o.seed,
                  o.errors, fs::absolute(root));
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
      return 0;
    }
    Task task{world.name,
              {fs::read_symlink("/proc/self/exe").string(), "--root", fs::absolute(root).string(),
               "discrepancies", "--plan", plan_file.string(), "--worlds", std::to_string(o.worlds),
               "--seed", std::to_string(o.seed), "--set", o.set, "--output", folder.string(),
               "--world", world.name},
              folder / world.name,
              hash_of(world, programs)};
    if (!o.errors.empty()) {
      task.command.emplace_back("--errors");
      task.command.push_back(o.errors);
    }
    tasks.push_back(std::move(task));
  }
  if (!o.world.empty()) throw std::invalid_argument("no world is called " + o.world);

  ScheduleDisplay display;
  SchedulerOptions options;
  options.workers = o.workers;
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
  const ReportTable table = table_of(results);
  common::Table text(table.header);
  for (const std::vector<std::string>& row : table.rows) text.add(row);
  text.print(out);
  out << "spreads: median; 90 %; worst\n";
  for (const std::string& failure : failures) out << "FAILED: " << failure << '\n';
  if (!o.json.empty())
    common::write_json({{"version", PALPATE_VERSION},
                        {"set", o.set},
                        {"seed", o.seed},
                        {"header", table.header},
                        {"rows", table.rows},
                        {"failures", failures},
                        {"worlds", results}},
                       o.json);
  return failures.empty() ? 0 : 1;
}

}  // namespace palpate::studies
