#include "tools/evaluate/thesis.hpp"

#include <algorithm>
#include <fstream>
#include <stdexcept>
#include <thread>

#include "tools/evaluate/interruption.hpp"
#include "tools/evaluate/process.hpp"
#include "tools/evaluate/table.hpp"
#include "tools/evaluate/thesis_hash.hpp"
#include "tools/evaluate/thesis_host.hpp"
#include "tools/evaluate/thesis_job.hpp"
#include "tools/evaluate/thesis_progress.hpp"
#include "tools/evaluate/thesis_report.hpp"
#include "tools/evaluate/thesis_scheduler.hpp"

namespace palpate::evaluate {
namespace {

namespace fs = std::filesystem;

constexpr int kCoresAJob = 2;  // simulator and daemon

int default_workers() {
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()) / kCoresAJob);
}

}  // namespace

struct ThesisCommand::Options {
  fs::path plan;
  fs::path output = "out/thesis";
  ThesisSelection selection;
  int workers = default_workers();
  bool list = false;
  bool report_only = false;
  bool keep_logs = false;
  std::string job;

  fs::path folder(const ThesisJob& wanted) const { return fs::absolute(output) / wanted.name; }

  /// What runs one job in a process of its own.
  std::vector<std::string> command_of(const ThesisJob& wanted, const fs::path& root,
                                      const fs::path& plan_file) const {
    std::vector<std::string> command{fs::read_symlink("/proc/self/exe").string(),
                                     "--root",
                                     fs::absolute(root).string(),
                                     "thesis",
                                     "--plan",
                                     plan_file.string(),
                                     "--out",
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
  for (const fs::path& program : thesis_programs()) hashes.push_back(hash_of_file(program));
  return hashes;
}

}  // namespace

ThesisCommand::ThesisCommand(CLI::App& app) : options_(std::make_unique<Options>()) {
  command_ = app.add_subcommand(
      "thesis",
      "runs the applications of the thesis (every method, model error and seed), scores them on "
      "the plant's truth and writes report.html, states.csv and thesis.json.\nWhat has been run "
      "with the same inputs and programs is not run again; Ctrl-C ends it, and the same command "
      "goes on where it stopped.");
  Options& o = *options_;
  command_->add_option("--plan", o.plan, "applications (default: tools/evaluate/thesis.yaml)")
      ->check(CLI::ExistingFile);
  command_->add_option("--out", o.output, "folder of the report, and of one folder a job")
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
  command_->add_flag("--keep-logs", o.keep_logs, "keep the LCM logs of the runs (about 4 MB/s)");
  CLI::Option* list = command_->add_flag("--list", o.list, "name the jobs and end");
  CLI::Option* report =
      command_->add_flag("--report-only", o.report_only, "report what has been run; run nothing");
  command_->add_option("--job", o.job, "run this one job here, as each of them is run")
      ->excludes(list)
      ->excludes(report);
}

ThesisCommand::~ThesisCommand() = default;

namespace {

void print_list(const std::vector<ThesisJob>& jobs, std::ostream& out) {
  Table table({"application", "method", "model error", "seed", "s", "job"});
  double simulated = 0;
  for (const ThesisJob& job : jobs) {
    simulated += job.duration;
    table.add({job.application, job.method, job.mismatch, std::to_string(job.seed),
               number(job.duration, 1), job.name});
  }
  table.print(out);
  out << jobs.size() << " jobs, " << number(simulated, 0) << " s simulated\n";
}

/// The result of a job; null where there is none. One of other inputs is no result of it.
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

/// Runs what has no result yet; the failures, with their last words.
std::vector<std::string> run_all(const std::vector<Task>& tasks, int workers, std::ostream& out) {
  ScheduleDisplay display;
  SchedulerOptions options;
  options.workers = workers;
  options.show = [&display](const ScheduleStatus& status) { display.show(status); };
  const std::vector<TaskOutcome> outcomes = run_tasks(tasks, options);
  std::vector<std::string> failures;
  for (const TaskOutcome& outcome : outcomes)
    if (outcome.state == TaskOutcome::State::kFailed)
      failures.push_back(outcome.name + ": " + outcome.failure);
  out << count_of(outcomes, TaskOutcome::State::kDone) << " jobs run, "
      << count_of(outcomes, TaskOutcome::State::kKept) << " kept, "
      << count_of(outcomes, TaskOutcome::State::kFailed) << " failed\n";
  return failures;
}

}  // namespace

std::optional<int> ThesisCommand::run(const fs::path& root, std::ostream& out) {
  if (!command_->parsed()) return std::nullopt;
  const Options& o = *options_;
  const fs::path plan_file =
      fs::absolute(o.plan.empty() ? root / "tools/evaluate/thesis.yaml" : o.plan);
  ThesisReport report;
  report.plan = read_thesis_plan(plan_file, fs::absolute(root));
  const std::vector<ThesisJob> jobs = thesis_jobs(report.plan, o.selection);
  if (o.list) {
    print_list(jobs, out);
    return 0;
  }
  catch_interruptions();
  const std::vector<std::string> programs = program_hashes();
  if (!o.job.empty()) {
    const auto job = std::find_if(jobs.begin(), jobs.end(),
                                  [&o](const ThesisJob& j) { return j.name == o.job; });
    if (job == jobs.end()) throw std::invalid_argument("no job is called " + o.job);
    fs::create_directories(o.folder(*job));
    run_thesis_job(*job, hash_of_inputs(*job, programs), o.folder(*job), o.keep_logs);
    return 0;
  }

  std::vector<Task> tasks;
  for (const ThesisJob& job : jobs)
    tasks.push_back({job.name, o.command_of(job, root, plan_file), o.folder(job),
                     hash_of_inputs(job, programs)});
  report.folder = fs::absolute(o.output);
  fs::create_directories(report.folder);
  report.host = describe_host();
  report.host["mode"] = o.selection.real_time ? "real time" : "lock-step";
  report.host["runs side by side"] = o.workers;
  if (!o.report_only) {
    report.failures = run_all(tasks, o.workers, out);
    report.host["load at the end"] = describe_host()["load"];
  }
  for (std::size_t i = 0; i < jobs.size(); ++i)
    report.results.push_back({jobs[i], result_of(tasks[i])});
  print_thesis(report, out);
  write_thesis(report);
  out << "\nreport.html, states.csv and thesis.json are in " << report.folder.string() << '\n';
  return report.failures.empty() ? 0 : 1;
}

}  // namespace palpate::evaluate
