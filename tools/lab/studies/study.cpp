#include "tools/lab/studies/study.hpp"

#include <algorithm>
#include <fstream>
#include <map>
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

constexpr int kCoresAJob = 2;          // simulator and daemon
constexpr int kReplaysSideBySide = 2;  // default

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
  fs::path output;
  fs::path json;
  StudySelection selection;
  int workers = default_workers();
  double cap = 100;  // mm
  bool list = false;
  bool report_only = false;
  bool keep_logs = false;
  bool pictures = false;
  std::string job;
  std::string shard;

  fs::path folder(const std::string& job_name) const { return fs::absolute(output) / job_name; }
};

StudyCommand::StudyCommand(CLI::App& app, Study study)
    : study_(std::move(study)), options_(std::make_unique<Options>()) {
  command_ = app.add_subcommand(
      study_.name,
      study_.about +
          ", scored on the plant's truth. Writes report.html, runs.csv, states.csv and " +
          study_.name +
          ".json.\nWhat has been run with the same inputs and programs is not run again; Ctrl-C "
          "ends it, and the same command goes on where it stopped.");
  Options& o = *options_;
  o.output = study_.output;
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
  command_->add_option("--json", o.json, "write the results to this file too");
  CLI::Option* list = command_->add_flag("--list", o.list, "name the jobs and end");
  CLI::Option* report =
      command_->add_flag("--report-only", o.report_only, "report what has been run; run nothing");
  command_
      ->add_option(
          "--shard", o.shard,
          study_.replayed
              ? "I/N: run the I-th of N equal parts of the recordings, with all methods on "
                "them, alone and report nothing; when all parts are in one folder "
                "--report-only reports them together"
              : "I/N: run the I-th of N equal parts of the jobs alone and report nothing; "
                "when all parts are in one folder --report-only reports them together")
      ->check(check_shard)
      ->excludes(list)
      ->excludes(report);
  command_->add_option("--job", o.job, "run this one job here, as each of them is run")
      ->excludes(list)
      ->excludes(report);
  const char* side_by_side = "runs side by side; each keeps about two cores busy";
  if (study_.replayed) {
    o.workers = kReplaysSideBySide;
    side_by_side = "recordings or replays side by side";
    command_->add_option("--cap", o.cap, "mm, what a failed run counts as, and the most of any")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    command_->add_flag("--pictures", o.pictures, "draw every state, for the report");
  } else {
    command_->add_flag("--real-time", o.selection.real_time,
                       "in real time instead of in lock-step, which does not depend on the load");
    command_->add_flag("--keep-logs", o.keep_logs, "keep the LCM logs of the runs (about 4 MB/s)");
  }
  command_->add_option("--jobs", o.workers, side_by_side)
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
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

/// Runs the jobs that have no result yet and prints `what`, such as "jobs: ", with the counts.
std::vector<TaskOutcome> run_all(const std::vector<Task>& tasks, int workers,
                                 const std::string& before, const std::string& run,
                                 std::ostream& out) {
  ScheduleDisplay display;
  SchedulerOptions options;
  options.workers = workers;
  options.show = [&display](const ScheduleStatus& status) { display.show(status); };
  std::vector<TaskOutcome> outcomes = run_tasks(tasks, options);
  std::map<TaskOutcome::State, int> count;
  for (const TaskOutcome& outcome : outcomes) ++count[outcome.state];
  out << before << count[TaskOutcome::State::kDone] << ' ' << run << ", "
      << count[TaskOutcome::State::kKept] << " kept, " << count[TaskOutcome::State::kFailed]
      << " failed\n";
  return outcomes;
}

/// What a call of the command has to run: recordings first, then one task per job.
struct Work {
  std::vector<Task> recordings;
  std::vector<StudyJob> jobs;
  std::vector<Task> tasks;  // of the jobs
};

void print_failures(const StudyReport& report, std::ostream& out) {
  for (const std::string& failure : report.failures) out << "FAILED: " << failure << '\n';
}

/// Runs the work and enters failures into the report.
void run_work(const Work& work, bool replayed, int workers, StudyReport& report,
              std::ostream& out) {
  // A failed recording makes its methods fail, and each reports it.
  if (replayed) run_all(work.recordings, workers, "recordings: ", "run", out);
  const std::vector<TaskOutcome> outcomes =
      replayed ? run_all(work.tasks, workers, "methods on recordings: ", "run", out)
               : run_all(work.tasks, workers, "", "jobs run", out);
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    if (outcomes[i].state != TaskOutcome::State::kFailed) continue;
    report.results[i].failed = true;
    report.failures.push_back(outcomes[i].name + ": " + outcomes[i].failure);
  }
}

}  // namespace

std::optional<int> StudyCommand::run(const fs::path& root, std::ostream& out) {
  if (!command_->parsed()) return std::nullopt;
  const Options& o = *options_;
  const bool replayed = study_.replayed;
  const fs::path plan_file = fs::absolute(o.plan.empty() ? root / study_.plan : o.plan);
  StudyReport report;
  report.name = study_.name;
  report.title = study_.title;
  report.folder = fs::absolute(o.output);
  report.plan = read_study_plan(plan_file, fs::absolute(root));
  const std::vector<StudyJob> jobs = study_jobs(report.plan, o.selection);
  if (o.list) {
    print_list(jobs, out);
    return 0;
  }
  for (const StudyJob& job : jobs)
    if (replayed && job.kind == "control")
      throw std::invalid_argument(job.application + ": what is controlled cannot be replayed");
  common::catch_interruptions();
  std::vector<std::string> programs;
  for (const fs::path& program : study_programs())
    if (!replayed) programs.push_back(hash_of_file(program));
  const auto hash_of = [&](const StudyJob& job, const std::string& recording) {
    return replayed ? hash_of_replay(job, recording, o.pictures) : hash_of_inputs(job, programs);
  };
  if (!o.job.empty()) {
    for (const StudyJob& job : jobs) {
      const std::string recording = recording_of(job);
      if (replayed && o.job == recording) {
        record_sensing(scene_of(job), o.folder(recording));
        return 0;
      }
      if (o.job != job.name) continue;
      fs::create_directories(o.folder(job.name));
      if (replayed)
        run_replayed_job(job, hash_of(job, hash_of_recording(scene_of(job))), o.folder(recording),
                         o.folder(job.name), o.pictures);
      else
        run_study_job(job, hash_of(job, ""), o.folder(job.name), o.keep_logs);
      return 0;
    }
    throw std::invalid_argument("no job is called " + o.job);
  }

  const auto task_of = [&](const std::string& name, const StudyJob& job, const std::string& hash) {
    Task task{name,
              {fs::read_symlink("/proc/self/exe").string(), "--root", fs::absolute(root).string(),
               study_.name, "--plan", plan_file.string(), "--output",
               fs::absolute(o.output).string(), "--seeds", std::to_string(job.seed), "--job", name},
              o.folder(name),
              hash};
    if (job.real_time) task.command.emplace_back("--real-time");
    if (o.keep_logs) task.command.emplace_back("--keep-logs");
    if (o.pictures) task.command.emplace_back("--pictures");
    return task;
  };
  Work work;
  std::map<std::string, std::string> recording_hashes;  // by name
  if (replayed) {
    for (const StudyJob& job : jobs) {
      const std::string name = recording_of(job);
      if (recording_hashes.count(name) > 0) continue;
      const std::string hash = recording_hashes[name] = hash_of_recording(scene_of(job));
      work.recordings.push_back(task_of(name, job, hash));
    }
    if (!o.shard.empty()) work.recordings = shard_of(work.recordings, read_shard(o.shard));
    std::copy_if(jobs.begin(), jobs.end(), std::back_inserter(work.jobs), [&](const StudyJob& job) {
      return std::any_of(work.recordings.begin(), work.recordings.end(),
                         [&](const Task& task) { return task.name == recording_of(job); });
    });
  } else {
    work.jobs = o.shard.empty() ? jobs : shard_of(jobs, read_shard(o.shard));
  }
  for (const StudyJob& job : work.jobs) {
    const std::string recording = replayed ? recording_hashes[recording_of(job)] : "";
    work.tasks.push_back(task_of(job.name, job, hash_of(job, recording)));
    report.results.push_back({job, {}, false});
  }
  fs::create_directories(report.folder);
  report.host = describe_host();
  report.host["mode"] = replayed                ? "recorded in lock-step, replayed"
                        : o.selection.real_time ? "real time"
                                                : "lock-step";
  report.host["runs side by side"] = o.workers;
  if (!o.report_only) {
    run_work(work, replayed, o.workers, report, out);
    report.host["load at the end"] = describe_host()["load"];
  }
  if (!o.shard.empty()) {
    print_failures(report, out);
    out << "shard " << o.shard << ": " << work.jobs.size() << " of " << jobs.size() << " jobs\n";
    return report.failures.empty() ? 0 : 1;
  }
  for (std::size_t i = 0; i < work.tasks.size(); ++i)
    report.results[i].json = result_of(work.tasks[i]);
  if (replayed)
    print_errors(report, o.cap, out);
  else
    print_study(report, out);
  print_failures(report, out);
  write_study(report);
  if (!o.json.empty())
    fs::copy_file(report.folder / (study_.name + ".json"), o.json,
                  fs::copy_options::overwrite_existing);
  out << '\n' << make_page(report, root) << '\n';
  return report.failures.empty() ? 0 : 1;
}

}  // namespace palpate::studies
