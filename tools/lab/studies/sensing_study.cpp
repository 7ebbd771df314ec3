#include "tools/lab/studies/sensing_study.hpp"

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "tools/common/bootstrap.hpp"
#include "tools/common/interruption.hpp"
#include "tools/common/output_files.hpp"
#include "tools/common/table.hpp"
#include "tools/lab/runs/live_run.hpp"
#include "tools/lab/studies/sensing_job.hpp"
#include "tools/lab/studies/shard.hpp"
#include "tools/lab/studies/study_host.hpp"
#include "tools/lab/studies/study_progress.hpp"
#include "tools/lab/studies/study_report.hpp"

namespace palpate::studies {

namespace fs = std::filesystem;
using Json = nlohmann::json;

struct SensingStudyCommand::Options {
  fs::path plan, output = "out/published-sensing";
  StudySelection selection;
  int jobs = 2;
  double cap = 100;  // mm
  bool list = false, pictures = false, report_only = false;
  std::string shard, job;

  fs::path folder(const std::string& name) const { return fs::absolute(output) / name; }

  /// Executes one job in a separate process.
  std::vector<std::string> command_of(const std::string& name, int seed, const fs::path& root,
                                      const fs::path& plan_file) const {
    std::vector<std::string> command{fs::read_symlink("/proc/self/exe").string(),
                                     "--root",
                                     fs::absolute(root).string(),
                                     "published-sensing",
                                     "--plan",
                                     plan_file.string(),
                                     "--output",
                                     fs::absolute(output).string(),
                                     "--seeds",
                                     std::to_string(seed),
                                     "--job",
                                     name};
    if (pictures) command.push_back("--pictures");
    return command;
  }
};

namespace {

std::string check_shard(const std::string& text) {
  try {
    read_shard(text);
    return "";
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
}

}  // namespace

SensingStudyCommand::SensingStudyCommand(CLI::App& app)
    : options_(std::make_unique<Options>()),
      command_(app.add_subcommand(
          "published-sensing",
          "the sensing methods of the thesis' Table 2.1 on one plant before a camera, beside "
          "palpate's own: each task is simulated once for each level of vision and seed, and every "
          "method is run on that recording. Writes report.html, runs.csv, states.csv and "
          "published-sensing.json.\nWhat has been run with the same inputs and programs is not run "
          "again; Ctrl-C ends it, and the same command goes on where it stopped.\nExample: "
          "palpate-evaluate published-sensing --quick "
          "--only \"bar soft\" --jobs 3")) {
  Options& o = *options_;
  command_->add_option("--plan", o.plan, "(default: tools/lab/studies/published_sensing.yaml)")
      ->check(CLI::ExistingFile);
  command_->add_option("--output", o.output, "folder of recordings, report and CSV")
      ->capture_default_str();
  command_
      ->add_option("--only", o.selection.applications,
                   "applications whose name holds this text (repeatable)")
      ->allow_extra_args(false);
  command_->add_option("--seeds", o.selection.seeds, "these instead of the plan's, e.g. 1,2,3")
      ->delimiter(',')
      ->check(CLI::NonNegativeNumber);
  command_->add_flag("--quick", o.selection.quick, "the first seed alone");
  command_->add_option("--jobs", o.jobs, "recordings or replays side by side")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  command_->add_option("--cap", o.cap, "mm, what a failed run counts as, and the most of any")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command_->add_flag("--pictures", o.pictures, "draw every state, for the report");
  CLI::Option* list = command_->add_flag("--list", o.list, "name the runs and end");
  CLI::Option* report =
      command_->add_flag("--report-only", o.report_only, "report what has been run; run nothing");
  command_
      ->add_option("--shard", o.shard,
                   "I/N: run the I-th of N equal parts of the recordings, with all methods on "
                   "them, alone and report nothing; when all parts are in one folder --report-only "
                   "reports them together")
      ->check(check_shard)
      ->excludes(list)
      ->excludes(report);
  command_->add_option("--job", o.job, "run this one job here, as each of them is run")
      ->excludes(list)
      ->excludes(report);
}

SensingStudyCommand::~SensingStudyCommand() = default;

namespace {

/// A task of the plan is simulated once for each level and seed: the name of that recording.
std::string recording_of(const StudyJob& job) {
  return "recordings/" +
         common::file_name(job.application + " " + job.mismatch + " " + std::to_string(job.seed));
}

/// Mean of a number over the states; the cap if the run failed, which is also the upper bound.
double mean_of(const StudyResult& result, const char* key, double cap) {
  if (!result.json.is_object()) return cap;
  double sum = 0;
  for (const Json& state : result.json["states"]) sum += std::min(cap, state[key].get<double>());
  return sum / static_cast<double>(result.json["states"].size());
}

/// One line per method, one column per level: nodes' mean error and the surfaces' distance, medians
/// over the seeds.
void print_table(const StudyReport& report, double cap, std::ostream& out) {
  for (const StudyApplication& application : report.plan.applications) {
    std::vector<std::string> header{application.name + ", mean / Hausdorff, mm"};
    for (const runs::Mismatch& level : application.levels) header.push_back(level.name);
    common::Table table(header);
    bool any = false;
    for (const runs::Method& method : application.methods) {
      std::vector<std::string> cells{method.name};
      for (const runs::Mismatch& level : application.levels) {
        std::vector<double> means, surfaces;
        for (const StudyResult& result : report.results) {
          const StudyJob& job = result.job;
          if (job.application != application.name || job.method != method.name ||
              job.mismatch != level.name || !(result.failed || result.json.is_object()))
            continue;
          means.push_back(mean_of(result, "mean_mm", cap));
          surfaces.push_back(mean_of(result, "hausdorff_mm", cap));
        }
        cells.push_back(means.empty() ? ""
                                      : common::number(common::median_of(means).value, 2) + " / " +
                                            common::number(common::median_of(surfaces).value, 2));
        any = any || !means.empty();
      }
      table.add(cells);
    }
    if (any) table.print(out);
    if (any) out << '\n';
  }
}

Json result_of(const Task& task) {
  if (!has_result(task)) return {};
  std::ifstream in(task.folder / "result.json");
  return Json::parse(in);
}

std::vector<TaskOutcome> run_shown(const std::vector<Task>& tasks, int workers) {
  ScheduleDisplay display;
  SchedulerOptions options;
  options.workers = workers;
  options.show = [&display](const ScheduleStatus& status) { display.show(status); };
  return run_tasks(tasks, options);
}

std::string counts_of(const std::vector<TaskOutcome>& outcomes) {
  std::map<TaskOutcome::State, int> count;
  for (const TaskOutcome& outcome : outcomes) ++count[outcome.state];
  return std::to_string(count[TaskOutcome::State::kDone]) + " run, " +
         std::to_string(count[TaskOutcome::State::kKept]) + " kept, " +
         std::to_string(count[TaskOutcome::State::kFailed]) + " failed";
}

}  // namespace

std::optional<int> SensingStudyCommand::run(const fs::path& root, std::ostream& out) {
  if (!command_->parsed()) return std::nullopt;
  const Options& o = *options_;
  StudyReport report;
  report.name = "published-sensing";
  report.title = "the published sensing methods on one plant before a camera";
  const fs::path plan_file =
      fs::absolute(o.plan.empty() ? root / "tools/lab/studies/published_sensing.yaml" : o.plan);
  report.plan = read_study_plan(plan_file, fs::absolute(root));
  const std::vector<StudyJob> jobs = study_jobs(report.plan, o.selection);
  if (o.list) {
    for (const StudyJob& job : jobs) out << job.name << '\n';
    out << jobs.size() << " runs\n";
    return 0;
  }
  for (const StudyJob& job : jobs)
    if (job.kind == "control")
      throw std::invalid_argument(job.application + ": what is controlled cannot be replayed");
  common::catch_interruptions();
  if (!o.job.empty()) {
    for (const StudyJob& job : jobs) {
      const std::string recording = recording_of(job);
      if (o.job == recording) {
        record_sensing(scene_of(job), o.folder(recording));
        return 0;
      }
      if (o.job != job.name) continue;
      fs::create_directories(o.folder(job.name));
      run_sensing_job(job, hash_of_replay(job, hash_of_recording(scene_of(job)), o.pictures),
                      o.folder(recording), o.folder(job.name), o.pictures);
      return 0;
    }
    throw std::invalid_argument("no job is called " + o.job);
  }

  std::vector<Task> recordings;
  std::map<std::string, std::string> hashes;  // by recording
  for (const StudyJob& job : jobs) {
    const std::string name = recording_of(job);
    if (hashes.count(name) > 0) continue;
    const std::string hash = hashes[name] = hash_of_recording(scene_of(job));
    recordings.push_back(
        {name, o.command_of(name, job.seed, root, plan_file), o.folder(name), hash});
  }
  if (!o.shard.empty()) recordings = shard_of(recordings, read_shard(o.shard));
  std::vector<Task> replays;
  for (const StudyJob& job : jobs) {
    const std::string name = recording_of(job);
    const bool mine = std::any_of(recordings.begin(), recordings.end(),
                                  [&name](const Task& task) { return task.name == name; });
    if (!mine) continue;
    replays.push_back({job.name, o.command_of(job.name, job.seed, root, plan_file),
                       o.folder(job.name), hash_of_replay(job, hashes[name], o.pictures)});
    report.results.push_back({job, {}, false});
  }
  if (!o.report_only) {
    fs::create_directories(fs::absolute(o.output));
    // A failed recording makes its methods fail, and each reports it.
    out << "recordings: " << counts_of(run_shown(recordings, o.jobs)) << '\n';
    const std::vector<TaskOutcome> outcomes = run_shown(replays, o.jobs);
    out << "methods on recordings: " << counts_of(outcomes) << '\n';
    for (std::size_t i = 0; i < outcomes.size(); ++i) {
      if (outcomes[i].state != TaskOutcome::State::kFailed) continue;
      report.results[i].failed = true;
      report.failures.push_back(outcomes[i].name + ": " + outcomes[i].failure);
    }
  }
  for (const std::string& failure : report.failures) out << "FAILED: " << failure << '\n';
  if (!o.shard.empty()) {
    out << "shard " << o.shard << ": " << replays.size() << " of " << jobs.size() << " jobs\n";
    return report.failures.empty() ? 0 : 1;
  }
  report.folder = fs::absolute(o.output);
  report.host = describe_host();
  report.host["mode"] = "recorded in lock-step, replayed";
  for (std::size_t i = 0; i < replays.size(); ++i) report.results[i].json = result_of(replays[i]);
  print_table(report, o.cap, out);
  write_study(report);
  out << "report.html, runs.csv, states.csv and published-sensing.json are in "
      << report.folder.string() << '\n';
  return report.failures.empty() ? 0 : 1;
}

}  // namespace palpate::studies
