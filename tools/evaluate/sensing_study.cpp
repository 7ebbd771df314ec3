#include "tools/evaluate/sensing_study.hpp"

#include <algorithm>
#include <fstream>
#include <iostream>
#include <list>
#include <map>
#include <nlohmann/json.hpp>
#include <tuple>

#include "rt/component/frames.hpp"
#include "tools/evaluate/csv.hpp"
#include "tools/evaluate/interruption.hpp"
#include "tools/evaluate/live_run.hpp"
#include "tools/evaluate/score.hpp"
#include "tools/evaluate/sensing_recording.hpp"
#include "tools/evaluate/study_host.hpp"
#include "tools/evaluate/study_picture.hpp"
#include "tools/evaluate/study_report.hpp"
#include "tools/evaluate/study_score.hpp"
#include "tools/evaluate/table.hpp"

namespace palpate::evaluate {

namespace fs = std::filesystem;
using Json = nlohmann::json;

struct SensingStudyCommand::Options {
  fs::path plan, output = "out/published-sensing";
  StudySelection selection;
  int jobs = 2;
  double cap = 100;  // mm
  bool list = false, pictures = false;
};

SensingStudyCommand::SensingStudyCommand(CLI::App& app)
    : options_(std::make_unique<Options>()),
      command_(app.add_subcommand(
          "published-sensing",
          "the sensing methods of the thesis' Table 2.1 on one plant before a camera, beside "
          "palpate's own: each task is simulated once for each level of vision and seed, and every "
          "method is run on that recording.\nExample: palpate-evaluate published-sensing --quick "
          "--only \"bar soft\" --jobs 3")) {
  Options& o = *options_;
  command_->add_option("--plan", o.plan, "(default: tools/evaluate/published_sensing.yaml)")
      ->check(CLI::ExistingFile);
  command_->add_option("--out", o.output, "folder of recordings, report and CSV")
      ->capture_default_str();
  command_
      ->add_option("--only", o.selection.applications,
                   "applications whose name holds this text (repeatable)")
      ->allow_extra_args(false);
  command_->add_option("--seeds", o.selection.seeds, "these instead of the plan's, e.g. 1,2,3")
      ->delimiter(',')
      ->check(CLI::NonNegativeNumber);
  command_->add_flag("--quick", o.selection.quick, "the first seed alone");
  command_->add_option("--jobs", o.jobs, "replays side by side")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  command_->add_option("--cap", o.cap, "mm, what a failed run counts as, and the most of any")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command_->add_flag("--pictures", o.pictures, "draw every state, for the report");
  command_->add_flag("--list", o.list, "name the runs and end");
}

SensingStudyCommand::~SensingStudyCommand() = default;

namespace {

struct Run {
  const StudyJob* job = nullptr;
  const SensingRecording* recording = nullptr;
  fs::path folder, output;
  std::unique_ptr<Process> process;
  Json result;
  std::string failure;
};

SensingScene scene_of(const StudyJob& job) {
  return {job.scene, job.scene_overrides, job.configuration, {}, job.duration};
}

Json scored(const Run& run, bool pictures) {
  const StudyJob& job = *run.job;
  RunLog log;
  LogReader reader(LogClock::kSent);
  reader.collect("SHAPE", log.shapes);
  reader.collect("SHAPE_MESH", log.shape_chunks);
  reader.collect("ESTIMATE", log.estimates);
  reader.read(run.output);
  log.truths = run.recording->truth.truths;
  log.truth_chunks = run.recording->truth.truth_chunks;
  log.truth_contacts = run.recording->truth.truth_contacts;
  log.observations = run.recording->truth.observations;
  ScoredRun score;
  score.stage = job.application;
  score.name = job.method;
  score.mismatch = job.mismatch;
  score.shape = score_shape(log);
  const config::Node configuration =
      config::Node::load_file(job.configuration.string(), job.daemon_overrides);
  const math::Pose X_WO = component::read_frames(configuration).X_WO;
  Json result{{"job",
               {{"name", job.name},
                {"application", job.application},
                {"kind", job.kind},
                {"method", job.method},
                {"model_error", job.mismatch},
                {"seed", job.seed},
                {"mode", "replayed"}}},
              {"score", to_json(score)}};
  int number = 0;
  for (const StateScore& state : score_states(job, log, *score.shape, X_WO)) {
    Json entry = to_json(state, score.shape->length);
    entry["picture"] = "";
    const std::string file = "state_" + std::to_string(++number) + ".png";
    if (pictures) {
      draw_state(state, X_WO, run.folder / file);
      entry["picture"] = file;
    }
    result["states"].push_back(std::move(entry));
  }
  result["shape_error"] = shape_curve(*score.shape);
  if (!log.estimates.empty())
    result["young_modulus_kPa"] = 1e-3 * std::exp(log.estimates.back().log_young_modulus);
  return result;
}

void end_run(Run& run, bool pictures) {
  const int code = *run.process->wait(0);
  run.process.reset();
  try {
    if (code != 0) throw RunFailed(tail(run.folder / "palpate-replay.txt", 8));
    run.result = scored(run, pictures);
    write_json(run.result, run.folder / "result.json");
  } catch (const Interrupted&) {
    throw;
  } catch (const std::exception& error) {
    run.failure = error.what();
  }
  fs::remove(run.output);
}

void replay_all(std::vector<Run>& runs, int jobs, bool pictures) {
  constexpr double kPoll = 0.02;  // s
  Progress progress(1, 1, std::to_string(runs.size()) + " methods on recordings");
  std::list<Run*> running;
  std::size_t next = 0, done = 0;
  while (done < runs.size()) {
    while (next < runs.size() && static_cast<int>(running.size()) < jobs) {
      Run& run = runs[next++];
      fs::create_directories(run.folder);
      run.output = run.folder / "replay.log";
      run.process = std::make_unique<Process>(
          "palpate-replay",
          replay_command(scene_of(*run.job), *run.recording, run.job->daemon_overrides, run.output),
          run.folder / "palpate-replay.txt");
      running.push_back(&run);
    }
    for (auto at = running.begin(); at != running.end();) {
      if (!(*at)->process->wait(0)) {
        ++at;
        continue;
      }
      end_run(**at, pictures);
      at = running.erase(at);
      progress.show(static_cast<double>(++done) / static_cast<double>(runs.size()));
    }
    throw_if_interrupted();
    sleep_for(kPoll);
  }
  progress.finish(true);
}

/// Mean over the states of a number; the cap where the run failed, and never more.
double mean_of(const Run& run, const char* key, double cap) {
  if (!run.result.is_object()) return cap;
  double sum = 0;
  for (const Json& state : run.result["states"]) sum += std::min(cap, state[key].get<double>());
  return sum / static_cast<double>(run.result["states"].size());
}

/// One line a method, one column a level: nodes' mean error, median of the seeds.
void print_table(const StudyPlan& plan, const std::vector<Run>& runs, double cap,
                 std::ostream& out) {
  for (const StudyApplication& application : plan.applications) {
    std::vector<std::string> header{application.name + ", mean / Hausdorff, mm"};
    for (const Mismatch& level : application.levels) header.push_back(level.name);
    Table table(header);
    bool any = false;
    for (const Method& method : application.methods) {
      std::vector<std::string> cells{method.name};
      for (const Mismatch& level : application.levels) {
        std::vector<double> means, surfaces;
        for (const Run& run : runs)
          if (run.job->application == application.name && run.job->method == method.name &&
              run.job->mismatch == level.name) {
            means.push_back(mean_of(run, "mean_mm", cap));
            surfaces.push_back(mean_of(run, "hausdorff_mm", cap));
          }
        const auto median = [](std::vector<double> values) {
          std::sort(values.begin(), values.end());
          return number(values[values.size() / 2], 2);
        };
        cells.push_back(means.empty() ? "" : median(means) + " / " + median(surfaces));
        any = any || !means.empty();
      }
      table.add(cells);
    }
    if (any) table.print(out);
    if (any) out << '\n';
  }
}

}  // namespace

std::optional<int> SensingStudyCommand::run(const fs::path& root, std::ostream& out) {
  if (!command_->parsed()) return std::nullopt;
  const Options& o = *options_;
  StudyReport report;
  report.name = "published-sensing";
  report.title = "the published sensing methods on one plant before a camera";
  report.plan = read_study_plan(
      o.plan.empty() ? root / "tools/evaluate/published_sensing.yaml" : fs::absolute(o.plan),
      fs::absolute(root));
  const std::vector<StudyJob> jobs = study_jobs(report.plan, o.selection);
  if (o.list) {
    for (const StudyJob& job : jobs) out << job.name << '\n';
    out << jobs.size() << " runs\n";
    return 0;
  }
  for (const StudyJob& job : jobs)
    if (job.kind == "control")
      throw std::invalid_argument(job.application + ": what is controlled cannot be replayed");
  catch_interruptions();
  report.folder = fs::absolute(o.output);
  fs::create_directories(report.folder);
  report.host = describe_host();
  report.host["mode"] = "recorded in lock-step, replayed";
  std::map<std::tuple<std::string, std::string, int>, SensingRecording> recordings;
  std::vector<Run> runs;
  for (const StudyJob& job : jobs) {
    const auto key = std::make_tuple(job.application, job.mismatch, job.seed);
    auto found = recordings.find(key);
    if (found == recordings.end()) {
      const fs::path folder =
          report.folder / "recordings" /
          file_name(job.application + " " + job.mismatch + " " + std::to_string(job.seed));
      found = recordings.emplace(key, record_sensing(scene_of(job), folder)).first;
    }
    Run run;
    run.job = &job;
    run.recording = &found->second;
    run.folder = report.folder / job.name;
    runs.push_back(std::move(run));
  }
  replay_all(runs, o.jobs, o.pictures);
  for (const Run& run : runs) {
    report.results.push_back({*run.job, run.result, !run.failure.empty()});
    if (!run.failure.empty()) report.failures.push_back(run.job->name + ": " + run.failure);
  }
  print_table(report.plan, runs, o.cap, out);
  for (const std::string& failure : report.failures) out << "FAILED: " << failure << '\n';
  write_study(report);
  out << "report.html, runs.csv, states.csv and published-sensing.json are in "
      << report.folder.string() << '\n';
  return report.failures.empty() ? 0 : 1;
}

}  // namespace palpate::evaluate
