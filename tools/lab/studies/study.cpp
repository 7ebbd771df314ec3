#include "tools/lab/studies/study.hpp"

#include <algorithm>
#include <fstream>
#include <stdexcept>
#include <thread>

#include "tools/common/interruption.hpp"
#include "tools/common/process.hpp"
#include "tools/common/table.hpp"
#include "tools/lab/studies/shard.hpp"
#include "tools/lab/studies/study_hash.hpp"
#include "tools/lab/studies/study_host.hpp"
#include "tools/lab/studies/study_job.hpp"
#include "tools/lab/studies/study_progress.hpp"
#include "tools/lab/studies/study_report.hpp"
#include "tools/lab/studies/study_scheduler.hpp"

namespace palpate::studies {
namespace {

namespace fs = std::filesystem;

constexpr int kCoresAJob = 2;  // simulator and daemon

std::string check_shard(const std::string& text) {
  try {
    read_shard(text);
    return "";
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
}

int default_workers() {
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()) / kCoresAJob);
}

}  // namespace

struct StudyCommand::Options {
  fs::path plan;
  std::string study;
  fs::path output;
  fs::path json;
  StudySelection selection;
  int workers = default_workers();
  bool list = false;
  bool report_only = false;
  bool keep_logs = false;
  std::string job;
  std::string shard;

  fs::path folder(const StudyJob& wanted) const { return fs::absolute(output) / wanted.name; }

  /// Executes one job in a separate process.
  std::vector<std::string> command_of(const StudyJob& wanted, const fs::path& root,
                                      const fs::path& plan_file) const {
    std::vector<std::string> command{fs::read_symlink("/proc/self/exe").string(),
                                     "--root",
                                     fs::absolute(root).string(),
                                     study,
                                     "--plan",
                                     plan_file.string(),
                                     "--output",
                                     fs::absolute(output).string(),
                                     "--seeds",
                                     std::to_string(wanted.seed),
                                     "--job",
                                     wanted.name};
    if (wanted.real_time) command.push_back("--real-time");
    if (keep_logs) command.push_back("--keep-logs");
    return command;
  }
};

namespace {

std::vector<std::string> program_hashes() {
  std::vector<std::string> hashes;
  for (const fs::path& program : study_programs()) hashes.push_back(hash_of_file(program));
  return hashes;
}

}  // namespace

StudyCommand::StudyCommand(CLI::App& app, Study study)
    : study_(std::move(study)), options_(std::make_unique<Options>()) {
  command_ = app.add_subcommand(
      study_.name,
      study_.about +
          ", scored on the plant's truth; writes report.html, runs.csv, states.csv and " +
          study_.name +
          ".json.\nWhat has been run with the same inputs and programs is not run again; Ctrl-C "
          "ends it, and the same command goes on where it stopped.");
  Options& o = *options_;
  o.study = study_.name;
  o.output = "out/" + study_.name;
  command_->add_option("--plan", o.plan, "applications (default: " + study_.plan.string() + ")")
      ->check(CLI::ExistingFile);
  command_->add_option("--output", o.output, "folder of the report, and of one folder a job")
      ->capture_default_str();
  command_
      ->add_option("--only", o.selection.applications,
                   "applications whose name holds this text (repeatable)")
      ->allow_extra_args(false);
  command_->add_option("--seeds", o.selection.seeds, "these instead of the plan's, e.g. 1,2,3")
      ->delimiter(',')
      ->check(CLI::NonNegativeNumber);
  command_->add_flag("--quick", o.selection.quick,
                     "the first seed alone, without what the plan marks `quick: false`");
  command_->add_option("--jobs", o.workers, "runs side by side; each keeps about two cores busy")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  command_->add_flag("--real-time", o.selection.real_time,
                     "in real time instead of in lock-step, which does not depend on the load");
  command_->add_option("--json", o.json, "write the results to this file too");
  command_->add_flag("--keep-logs", o.keep_logs, "keep the LCM logs of the runs (about 4 MB/s)");
  CLI::Option* list = command_->add_flag("--list", o.list, "name the jobs and end");
  CLI::Option* report =
      command_->add_flag("--report-only", o.report_only, "report what has been run; run nothing");
  command_
      ->add_option("--shard", o.shard,
                   "I/N: run the I-th of N equal parts of the jobs alone and report nothing; when "
                   "all parts are in one folder --report-only reports them together")
      ->check(check_shard)
      ->excludes(list)
      ->excludes(report);
  command_->add_option("--job", o.job, "run this one job here, as each of them is run")
      ->excludes(list)
      ->excludes(report);
}

StudyCommand::~StudyCommand() = default;

namespace {

void print_list(const std::vector<StudyJob>& jobs, std::ostream& out) {
  common::Table table({"application", "method", "model error", "seed", "s", "job"});
  double simulated = 0;
  for (const StudyJob& job : jobs) {
    simulated += job.duration;
    table.add({job.application, job.method, job.mismatch, std::to_string(job.seed),
               common::number(job.duration, 1), job.name});
  }
  table.print(out);
  out << jobs.size() << " jobs, " << common::number(simulated, 0) << " s simulated\n";
}

/// The result of a job; null if there is none. A result of other inputs does not count.
nlohmann::json result_of(const Task& task) {
  if (!has_result(task)) return {};
  std::ifstream in(task.folder / "result.json");
  return nlohmann::json::parse(in);
}

std::string count_of(const std::vector<TaskOutcome>& outcomes, TaskOutcome::State state) {
  return std::to_string(
      std::count_if(outcomes.begin(), outcomes.end(),
                    [state](const TaskOutcome& outcome) { return outcome.state == state; }));
}

/// Runs the jobs that have no result yet. One outcome per task.
std::vector<TaskOutcome> run_all(const std::vector<Task>& tasks, int workers, std::ostream& out) {
  ScheduleDisplay display;
  SchedulerOptions options;
  options.workers = workers;
  options.show = [&display](const ScheduleStatus& status) { display.show(status); };
  std::vector<TaskOutcome> outcomes = run_tasks(tasks, options);
  out << count_of(outcomes, TaskOutcome::State::kDone) << " jobs run, "
      << count_of(outcomes, TaskOutcome::State::kKept) << " kept, "
      << count_of(outcomes, TaskOutcome::State::kFailed) << " failed\n";
  return outcomes;
}

}  // namespace

std::optional<int> StudyCommand::run(const fs::path& root, std::ostream& out) {
  if (!command_->parsed()) return std::nullopt;
  const Options& o = *options_;
  const fs::path plan_file = fs::absolute(o.plan.empty() ? root / study_.plan : o.plan);
  StudyReport report;
  report.name = study_.name;
  report.title = study_.title;
  report.plan = read_study_plan(plan_file, fs::absolute(root));
  const std::vector<StudyJob> jobs = study_jobs(report.plan, o.selection);
  if (o.list) {
    print_list(jobs, out);
    return 0;
  }
  common::catch_interruptions();
  const std::vector<std::string> programs = program_hashes();
  if (!o.job.empty()) {
    const auto job =
        std::find_if(jobs.begin(), jobs.end(), [&o](const StudyJob& j) { return j.name == o.job; });
    if (job == jobs.end()) throw std::invalid_argument("no job is called " + o.job);
    fs::create_directories(o.folder(*job));
    run_study_job(*job, hash_of_inputs(*job, programs), o.folder(*job), o.keep_logs);
    return 0;
  }

  std::vector<Task> tasks;
  for (const StudyJob& job : jobs)
    tasks.push_back({job.name, o.command_of(job, root, plan_file), o.folder(job),
                     hash_of_inputs(job, programs)});
  if (!o.shard.empty()) {
    const std::vector<Task> part = shard_of(tasks, read_shard(o.shard));
    int failed = 0;
    for (const TaskOutcome& outcome : run_all(part, o.workers, out)) {
      if (outcome.state != TaskOutcome::State::kFailed) continue;
      out << outcome.name << ": " << outcome.failure << '\n';
      ++failed;
    }
    out << "shard " << o.shard << ": " << part.size() << " of " << tasks.size() << " jobs\n";
    return failed == 0 ? 0 : 1;
  }
  report.folder = fs::absolute(o.output);
  fs::create_directories(report.folder);
  report.host = describe_host();
  report.host["mode"] = o.selection.real_time ? "real time" : "lock-step";
  report.host["runs side by side"] = o.workers;
  for (std::size_t i = 0; i < jobs.size(); ++i) report.results.push_back({jobs[i], {}, false});
  if (!o.report_only) {
    const std::vector<TaskOutcome> outcomes = run_all(tasks, o.workers, out);
    for (std::size_t i = 0; i < jobs.size(); ++i) {
      if (outcomes[i].state != TaskOutcome::State::kFailed) continue;
      report.results[i].failed = true;
      report.failures.push_back(outcomes[i].name + ": " + outcomes[i].failure);
    }
    report.host["load at the end"] = describe_host()["load"];
  }
  for (std::size_t i = 0; i < jobs.size(); ++i) report.results[i].json = result_of(tasks[i]);
  print_study(report, out);
  write_study(report);
  if (!o.json.empty())
    fs::copy_file(report.folder / (study_.name + ".json"), o.json,
                  fs::copy_options::overwrite_existing);
  out << "\nreport.html, runs.csv, states.csv and " << study_.name << ".json are in "
      << report.folder.string() << '\n';
  return report.failures.empty() ? 0 : 1;
}

}  // namespace palpate::studies
