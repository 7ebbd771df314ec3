#include "tools/lab/studies/study.hpp"

#include <algorithm>
#include <fstream>
#include <map>
#include <set>
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

/// As on the command line.
std::vector<std::string> arguments_of(const LevelSelection& levels) {
  std::vector<std::string> arguments;
  for (const std::string& level : levels.levels) {
    arguments.emplace_back("--mismatch");
    arguments.push_back(level);
  }
  if (levels.draws > 0) {
    arguments.emplace_back("--draws");
    arguments.push_back(std::to_string(levels.draws));
  }
  if (levels.draw_seed) {
    arguments.emplace_back("--draw-seed");
    arguments.push_back(std::to_string(*levels.draw_seed));
  }
  return arguments;
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
  LevelSelection levels;
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

/// Hashes of the inputs of jobs and recordings.
class StudyCommand::Hashes {
 public:
  Hashes(bool replayed, bool pictures) : replayed_(replayed), pictures_(pictures) {
    for (const fs::path& program : study_programs())
      if (!replayed) programs_.push_back(hash_of_file(program));
  }
  std::string of(const StudyJob& job) const {
    return replayed_ ? hash_of_replay(job, of_recording(job), pictures_)
                     : hash_of_inputs(job, programs_);
  }
  /// Each recording serves many jobs.
  const std::string& of_recording(const StudyJob& job) const {
    std::string& hash = recordings_[recording_of(job)];
    if (hash.empty()) hash = hash_of_recording(scene_of(job));
    return hash;
  }

 private:
  const bool replayed_, pictures_;
  std::vector<std::string> programs_;
  mutable std::map<std::string, std::string> recordings_;
};

/// What a call of the command has to run: recordings first, then one task per job.
struct StudyCommand::Work {
  std::vector<Task> recordings;
  std::vector<StudyJob> jobs;
  std::vector<Task> tasks;  // of the jobs
};

StudyCommand::StudyCommand(CLI::App& app, Study study)
    : study_(std::move(study)), options_(std::make_unique<Options>()) {
  command_ = app.add_subcommand(
      study_.name,
      study_.about +
          ", scored on the plant's truth. Writes report.html, runs.csv, states.csv and " +
          study_.name +
          ".json.\nWhat has been run with the same inputs and programs is not run again; Ctrl-C "
          "ends it, and the same command resumes where it stopped.");
  Options& o = *options_;
  o.output = study_.output;
  command_
      ->add_option("--plan", o.plan,
                   "plan of the applications (default: " + study_.plan.string() + ")")
      ->check(CLI::ExistingFile);
  command_->add_option("--output", o.output, "folder of the report, and of one folder a job")
      ->capture_default_str();
  command_
      ->add_option("--only", o.selection.applications,
                   "applications whose name holds this text (repeatable)")
      ->allow_extra_args(false);
  command_->add_option("--seeds", o.selection.seeds, "seeds instead of the plan's, e.g. 1,2,3")
      ->delimiter(',')
      ->check(CLI::NonNegativeNumber);
  command_
      ->add_option(
          "--mismatch", o.levels.levels,
          "model errors instead of the plan's (repeatable): none, all, calibrated for draws "
          "from that distribution, \"calibrated 17\" for one of them")
      ->allow_extra_args(false);
  command_
      ->add_option("--draws", o.levels.draws,
                   "number of draws of a distribution (default: the plan's)")
      ->check(CLI::Range(1, 100000));
  command_->add_option("--draw-seed", o.levels.draw_seed, "seed of the draws (default: the plan's)")
      ->check(CLI::NonNegativeNumber);
  command_->add_flag("--quick", o.selection.quick,
                     "the first seed alone, without what the plan marks `quick: false`");
  command_->add_option("--json", o.json, "file for the results, in addition");
  CLI::Option* list = command_->add_flag("--list", o.list, "list of the jobs; nothing is run");
  CLI::Option* report = command_->add_flag("--report-only", o.report_only,
                                           "report of existing results; nothing is run");
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
  command_->add_option("--job", o.job, "name of a single job, run in this process")
      ->excludes(list)
      ->excludes(report);
  const char* side_by_side = "runs side by side; each keeps about two cores busy";
  if (study_.replayed) {
    o.workers = kReplaysSideBySide;
    side_by_side = "recordings or replays side by side";
    command_->add_option("--cap", o.cap, "mm, error of a failed run and upper limit of any error")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    command_->add_flag("--pictures", o.pictures, "pictures of every state, for the report");
  } else {
    command_->add_flag("--real-time", o.selection.real_time,
                       "real time instead of lock-step, which does not depend on the load");
    command_->add_flag("--keep-logs", o.keep_logs, "keep the LCM logs of the runs (about 4 MB/s)");
  }
  command_->add_option("--jobs", o.workers, side_by_side)
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
}

StudyCommand::~StudyCommand() = default;

void StudyCommand::run_one(const std::vector<StudyJob>& jobs, const Hashes& hashes) const {
  const Options& o = *options_;
  for (const StudyJob& job : jobs) {
    const std::string recording = recording_of(job);
    if (study_.replayed && o.job == recording) {
      record_sensing(scene_of(job), o.folder(recording));
      return;
    }
    if (o.job != job.name) continue;
    fs::create_directories(o.folder(job.name));
    if (study_.replayed)
      run_replayed_job(job, hashes.of(job), o.folder(recording), o.folder(job.name), o.pictures);
    else
      run_study_job(job, hashes.of(job), o.folder(job.name), o.keep_logs);
    return;
  }
  throw std::invalid_argument("no job is called " + o.job);
}

StudyCommand::Work StudyCommand::work_of(const std::vector<StudyJob>& jobs, const Hashes& hashes,
                                         const fs::path& root, const fs::path& plan_file) const {
  const Options& o = *options_;
  const auto task_of = [&](const std::string& name, const StudyJob& job, const std::string& hash) {
    Task task{name,
              {fs::read_symlink("/proc/self/exe").string(), "--root", root.string(), study_.name,
               "--plan", plan_file.string(), "--output", fs::absolute(o.output).string(), "--seeds",
               std::to_string(job.seed), "--job", name},
              o.folder(name),
              hash};
    // Not all draws again in each process.
    LevelSelection levels = o.levels;
    if (!job.family.empty()) levels.levels = {job.mismatch};
    for (const std::string& argument : arguments_of(levels)) task.command.push_back(argument);
    if (job.real_time) task.command.emplace_back("--real-time");
    if (o.keep_logs) task.command.emplace_back("--keep-logs");
    if (o.pictures) task.command.emplace_back("--pictures");
    return task;
  };
  Work work;
  if (study_.replayed) {
    std::set<std::string> known;
    for (const StudyJob& job : jobs)
      if (known.insert(recording_of(job)).second)
        work.recordings.push_back(task_of(recording_of(job), job, hashes.of_recording(job)));
    if (!o.shard.empty()) work.recordings = shard_of(work.recordings, read_shard(o.shard));
    std::copy_if(jobs.begin(), jobs.end(), std::back_inserter(work.jobs), [&](const StudyJob& job) {
      return std::any_of(work.recordings.begin(), work.recordings.end(),
                         [&](const Task& task) { return task.name == recording_of(job); });
    });
  } else {
    work.jobs = o.shard.empty() ? jobs : shard_of(jobs, read_shard(o.shard));
  }
  for (const StudyJob& job : work.jobs)
    work.tasks.push_back(task_of(job.name, job, hashes.of(job)));
  return work;
}

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

/// Runs the tasks that have no result yet and prints their counts: `before`3 `run`, 0 kept, 1
/// failed.
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

void print_failures(const StudyReport& report, std::ostream& out) {
  for (const std::string& failure : report.failures) out << "FAILED: " << failure << '\n';
}

}  // namespace

void StudyCommand::run_work(const Work& work, StudyReport& report, std::ostream& out) const {
  const int workers = options_->workers;
  const bool replayed = study_.replayed;
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

std::optional<int> StudyCommand::run(const fs::path& root, std::ostream& out) {
  if (!command_->parsed()) return std::nullopt;
  const Options& o = *options_;
  const fs::path plan_file = fs::absolute(o.plan.empty() ? root / study_.plan : o.plan);
  StudyReport report;
  report.name = study_.name;
  report.title = study_.title;
  report.folder = fs::absolute(o.output);
  report.plan = read_study_plan(plan_file, fs::absolute(root), o.levels);
  const std::vector<StudyJob> jobs = study_jobs(report.plan, o.selection);
  if (o.list) {
    print_list(jobs, out);
    return 0;
  }
  for (const StudyJob& job : jobs)
    if (study_.replayed && job.kind == "control")
      throw std::invalid_argument(job.application + ": what is controlled cannot be replayed");
  common::catch_interruptions();
  const Hashes hashes(study_.replayed, o.pictures);
  if (!o.job.empty()) {
    run_one(jobs, hashes);
    return 0;
  }

  const Work work = work_of(jobs, hashes, fs::absolute(root), plan_file);
  for (const StudyJob& job : work.jobs) report.results.push_back({job, {}, false});
  fs::create_directories(report.folder);
  report.host = describe_host();
  report.host["mode"] = study_.replayed         ? "recorded in lock-step, replayed"
                        : o.selection.real_time ? "real time"
                                                : "lock-step";
  report.host["runs side by side"] = o.workers;
  if (!o.report_only) {
    run_work(work, report, out);
    report.host["load at the end"] = describe_host()["load"];
  }
  if (!o.shard.empty()) {
    print_failures(report, out);
    out << "shard " << o.shard << ": " << work.jobs.size() << " of " << jobs.size() << " jobs\n";
    return report.failures.empty() ? 0 : 1;
  }
  for (std::size_t i = 0; i < work.tasks.size(); ++i)
    report.results[i].json = result_of(work.tasks[i]);
  if (study_.replayed) print_errors(report, o.cap, out);
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
