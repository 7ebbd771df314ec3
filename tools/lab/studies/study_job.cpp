#include "tools/lab/studies/study_job.hpp"

#include <algorithm>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <palpate/channels.hpp>
#include <sstream>

#include "rt/config/node.hpp"
#include "rt/registry/frames.hpp"
#include "sim/scenes/scene.hpp"
#include "tools/common/output_files.hpp"
#include "tools/lab/runs/live_run.hpp"
#include "tools/lab/scores/belief_score.hpp"
#include "tools/lab/scores/reached_shape.hpp"
#include "tools/lab/scores/score.hpp"
#include "tools/lab/studies/poke_score.hpp"
#include "tools/lab/studies/study_hash.hpp"
#include "tools/lab/studies/study_picture.hpp"
#include "tools/lab/studies/study_score.hpp"
#include "tools/lab/studies/study_tactile.hpp"

namespace palpate::studies {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr double kSlack = 10;          // s in real time; the scene ends the run
constexpr double kJobPatience = 1500;  // s

/// A controller that plans before the hand moves needs the target at that time.
std::string goal_of(const Eigen::VectorXd& values) {
  std::ostringstream text;
  text.precision(9);
  for (Eigen::Index i = 0; i < values.size(); ++i) text << (i == 0 ? "" : ", ") << values[i];
  return "control.goal={values: [" + text.str() + "]}";
}

bool plans_ahead(const StudyJob& job) {
  return std::any_of(job.daemon_overrides.begin(), job.daemon_overrides.end(),
                     [](const std::string& setting) {
                       return setting.find("control.provider=inverse_elements") == 0 ||
                              setting == "control.provider=rheological_chain";
                     });
}

runs::RunPlan plan_of(const StudyJob& job) {
  runs::RunPlan plan;
  plan.name = job.name;
  plan.source.scene = job.scene;
  plan.source.scene_overrides = job.scene_overrides;
  plan.source.duration = job.duration;
  plan.configuration = job.configuration;
  plan.overrides = job.daemon_overrides;
  plan.duration = job.duration + kSlack;
  plan.target = job.target;
  if (plan.target && plan.target->hand)
    plan.target->values = scores::reached_value(job.scene, *plan.target, *plan.target->hand);
  if (plan.target && plans_ahead(job)) plan.overrides.push_back(goal_of(plan.target->values));
  plan.settled = plan.duration;  // every run of an application has the same duration
  plan.lock_step = !job.real_time;
  return plan;
}

Json json_in(const fs::path& file) {
  std::ifstream in(file);
  return Json::parse(in, nullptr, false);
}

/// The parameters of a drawn model error.
Json drawn_of(const StudyJob& job) {
  Json parameters = Json::array();
  for (const runs::DrawnValue& value : job.drawn)
    parameters.push_back(
        {{"parameter", value.parameter}, {"unit", value.unit}, {"value", value.value}});
  return {{"distribution", job.family}, {"name", job.mismatch}, {"parameters", parameters}};
}

/// The head of every result.
Json result_head(const StudyJob& job, const std::string& inputs_hash, const char* mode) {
  Json head{{"inputs_hash", inputs_hash},
            {"version", PALPATE_VERSION},
            {"job",
             {{"name", job.name},
              {"application", job.application},
              {"kind", job.kind},
              {"method", job.method},
              {"model_error", job.mismatch},
              {"seed", job.seed},
              {"mode", mode}}}};
  if (!job.family.empty()) head["draw"] = drawn_of(job);
  return head;
}

scores::ScoredRun scored_run(const StudyJob& job) {
  scores::ScoredRun scored;
  scored.stage = job.application;
  scored.name = job.method;
  scored.mismatch = job.mismatch;
  return scored;
}

registry::Frames frames_of(const StudyJob& job) {
  return registry::read_frames(
      config::Node::load_file(job.configuration.string(), job.daemon_overrides));
}

/// A result is written completely or not at all; the parameters of its draw also alone.
void write_result(const Json& result, const fs::path& folder) {
  if (result.contains("draw")) common::write_json(result["draw"], folder / "draw.json");
  common::write_json(result, folder / "result.json.part");
  fs::rename(folder / "result.json.part", folder / "result.json");
}

/// Images are for human readers: a job without them is still scored.
std::string picture_of(const StateScore& state, std::size_t number, const math::Pose& X_WO,
                       const fs::path& folder) {
  const std::string file = "state_" + std::to_string(number) + ".png";
  try {
    draw_state(state, X_WO, folder / file);
    return file;
  } catch (const std::exception& error) {
    std::cout << "no picture of " << state.name << ": " << error.what() << '\n';
    return "";
  }
}

/// One FEATURE per cycle; those missing in the log were lost by UDP on the way there.
std::int64_t lost_by(const log::RunLog& log, const runs::RunFiles& files) {
  return json_in(files.daemon).value("cycles", std::int64_t{0}) -
         static_cast<std::int64_t>(log.features.size());
}

/// A log that misses more than one cycle of 200 cannot be scored: a machine too busy for the
/// recorder gets two more attempts.
log::RunLog run_and_read(const StudyJob& job, const runs::RunPlan& plan, const fs::path& folder,
                         runs::RunFiles& files) {
  constexpr int kTries = 3;
  for (int attempt = 1;; ++attempt) {
    common::Progress progress(1, 1, job.name);
    files = runs::run_live(plan, folder, progress);
    progress.finish(true);
    log::RunLog log =
        log::read_run(files.control, files.housekeeping,
                      job.real_time ? log::LogClock::kReceived : log::LogClock::kSent);
    const std::int64_t lost = lost_by(log, files);
    if (lost * 200 <= static_cast<std::int64_t>(log.features.size())) return log;
    const std::string what = "the log misses " + std::to_string(lost) + " cycles of " +
                             std::to_string(lost + static_cast<std::int64_t>(log.features.size())) +
                             ": the machine is too busy to record the run";
    if (attempt == kTries) throw runs::RunFailed(what + ", in each of three tries");
    std::cout << what << "; once more\n";
  }
}

}  // namespace

void run_study_job(const StudyJob& job, const std::string& inputs_hash, const fs::path& folder,
                   bool keep_logs) {
  const runs::RunPlan plan = plan_of(job);
  runs::RunFiles files;
  const log::RunLog log = run_and_read(job, plan, folder, files);
  scores::ScoredRun scored = scored_run(job);
  const registry::Frames frames = frames_of(job);
  const math::Pose& X_WO = frames.X_WO;
  const scenes::Scene scene =
      scenes::read_scene(config::Node::load_file(job.scene.string(), job.scene_overrides));
  const math::Pose X_OP = X_WO.inverse() * scene.X_WO;
  scores::score_into(scored, log, scores::gate_of(plan), job.target ? &*job.target : nullptr, X_OP);

  Json result = result_head(job, inputs_hash, job.real_time ? "real time" : "lock-step");
  result["score"] = to_json(scored);
  // A stepped daemon has no clock relative to which it could be late.
  if (!job.real_time) result["score"]["loop"].erase("latency_us");
  result["simulator"] = json_in(files.simulator);
  result["features_lost_by_log"] = lost_by(log, files);
  std::vector<StateScore> states = score_states(job, log, *scored.shape, X_WO, X_OP);
  for (std::size_t i = 0; i < states.size(); ++i) {
    Json state = to_json(states[i], scored.shape->length);
    if (job.kind == "tactile") {
      const auto utime = log.shapes.front().utime + static_cast<std::int64_t>(states[i].time * 1e6);
      add_tactile_score(job, log, X_WO, utime, states[i].shapes, state);
    }
    state["picture"] = picture_of(states[i], i + 1, X_WO, folder);
    result["states"].push_back(std::move(state));
  }
  result["belief"] = to_json(scores::score_belief(log, X_OP));
  if (!scene.pokes.empty())
    result["pokes"] =
        to_json(score_pokes(scene.pokes, log, *scored.shape, frames, X_OP), scored.shape->length);
  result["shape_error"] = shape_curve(*scored.shape);
  if (scored.feature) result["control"] = control_curves(*scored.feature, log);
  write_result(result, folder);
  if (keep_logs) return;
  fs::remove(files.control);
  fs::remove(files.housekeeping);
}

SensingScene scene_of(const StudyJob& job) {
  return {job.scene, job.scene_overrides, job.configuration, {}, job.duration};
}

std::string recording_of(const StudyJob& job) {
  return "recordings/" +
         common::file_name(job.application + " " + job.mismatch + " " + std::to_string(job.seed));
}

std::string hash_of_replay(const StudyJob& job, const std::string& recording_hash, bool pictures) {
  const fs::path programs = common::program_folder();
  return hash_of_inputs(
      job, {recording_hash, hash_of_file(programs / "palpate-replay"),
            hash_of_file(programs / "palpate-evaluate"), pictures ? "drawn" : "not drawn"});
}

void run_replayed_job(const StudyJob& job, const std::string& inputs_hash, const fs::path& recorded,
                      const fs::path& folder, bool pictures) {
  SensingRecording recording = read_recording(scene_of(job), recorded);
  log::RunLog log;
  log.truths = std::move(recording.truth.truths);
  log.truth_chunks = std::move(recording.truth.truth_chunks);
  log.truth_contacts = std::move(recording.truth.truth_contacts);
  log.observations = std::move(recording.truth.observations);
  log::LogReader reader(log::LogClock::kSent);
  reader.collect(channel::kShape, log.shapes);
  reader.collect(channel::kShapeMesh, log.shape_chunks);
  reader.collect(channel::kEstimate, log.estimates);
  replay(scene_of(job), recording, job.daemon_overrides, folder, kJobPatience, reader);

  scores::ScoredRun scored = scored_run(job);
  const registry::Frames frames = frames_of(job);
  const math::Pose& X_WO = frames.X_WO;
  const scenes::Scene scene =
      scenes::read_scene(config::Node::load_file(job.scene.string(), job.scene_overrides));
  const math::Pose X_OP = X_WO.inverse() * scene.X_WO;
  scored.shape = scores::score_shape(log, X_OP);
  Json result = result_head(job, inputs_hash, "replayed");
  result["score"] = to_json(scored);
  const std::vector<StateScore> states = score_states(job, log, *scored.shape, X_WO, X_OP);
  for (std::size_t i = 0; i < states.size(); ++i) {
    Json state = to_json(states[i], scored.shape->length);
    state["picture"] = pictures ? picture_of(states[i], i + 1, X_WO, folder) : "";
    result["states"].push_back(std::move(state));
  }
  result["belief"] = to_json(scores::score_belief(log, X_OP));
  if (!scene.pokes.empty() && !log.estimates.empty())
    result["pokes"] =
        to_json(score_pokes(scene.pokes, log, *scored.shape, frames, X_OP), scored.shape->length);
  result["shape_error"] = shape_curve(*scored.shape);
  write_result(result, folder);
}

}  // namespace palpate::studies
