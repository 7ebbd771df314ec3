#include "tools/lab/studies/sensing_job.hpp"

#include <nlohmann/json.hpp>

#include "rt/registry/frames.hpp"
#include "tools/common/output_files.hpp"
#include "tools/lab/runs/live_run.hpp"
#include "tools/lab/scores/report.hpp"
#include "tools/lab/studies/study_hash.hpp"
#include "tools/lab/studies/study_picture.hpp"
#include "tools/lab/studies/study_score.hpp"

namespace palpate::studies {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr double kPatience = 1500;  // s, of a replay

Json scored(const StudyJob& job, const log::RunLog& log, const fs::path& folder, bool pictures) {
  scores::ScoredRun score;
  score.stage = job.application;
  score.name = job.method;
  score.mismatch = job.mismatch;
  score.shape = scores::score_shape(log);
  const config::Node configuration =
      config::Node::load_file(job.configuration.string(), job.daemon_overrides);
  const math::Pose X_WO = registry::read_frames(configuration).X_WO;
  Json result{{"score", to_json(score)},
              {"job",
               {{"name", job.name},
                {"application", job.application},
                {"kind", job.kind},
                {"method", job.method},
                {"model_error", job.mismatch},
                {"seed", job.seed},
                {"mode", "replayed"}}}};
  int number = 0;
  for (const StateScore& state : score_states(job, log, *score.shape, X_WO)) {
    Json entry = to_json(state, score.shape->length);
    entry["picture"] = "";
    const std::string file = "state_" + std::to_string(++number) + ".png";
    if (pictures) {
      draw_state(state, X_WO, folder / file);
      entry["picture"] = file;
    }
    result["states"].push_back(std::move(entry));
  }
  result["shape_error"] = shape_curve(*score.shape);
  if (!log.estimates.empty())
    result["young_modulus_kPa"] = 1e-3 * std::exp(log.estimates.back().log_young_modulus);
  return result;
}

}  // namespace

SensingScene scene_of(const StudyJob& job) {
  return {job.scene, job.scene_overrides, job.configuration, {}, job.duration};
}

std::string hash_of_replay(const StudyJob& job, const std::string& recording_hash, bool pictures) {
  const fs::path programs = common::program_folder();
  return hash_of_inputs(
      job, {recording_hash, hash_of_file(programs / "palpate-replay"),
            hash_of_file(programs / "palpate-evaluate"), pictures ? "drawn" : "not drawn"});
}

void run_sensing_job(const StudyJob& job, const std::string& inputs_hash, const fs::path& recorded,
                     const fs::path& folder, bool pictures) {
  SensingRecording recording = read_recording(scene_of(job), recorded);
  const fs::path replayed = folder / "replay.log", said = folder / "palpate-replay.txt";
  const int code = common::run_to_end(
      replay_command(scene_of(job), recording, job.daemon_overrides, replayed), said, kPatience);
  if (code != 0)
    throw runs::RunFailed("palpate-replay, exit code " + std::to_string(code) + ":\n" +
                          common::tail(said, 8));
  log::RunLog log;
  log.truths = std::move(recording.truth.truths);
  log.truth_chunks = std::move(recording.truth.truth_chunks);
  log.truth_contacts = std::move(recording.truth.truth_contacts);
  log.observations = std::move(recording.truth.observations);
  log::LogReader reader(log::LogClock::kSent);
  reader.collect("SHAPE", log.shapes);
  reader.collect("SHAPE_MESH", log.shape_chunks);
  reader.collect("ESTIMATE", log.estimates);
  reader.read(replayed);
  fs::remove(replayed);
  Json result = scored(job, log, folder, pictures);
  result["inputs_hash"] = inputs_hash;
  result["version"] = PALPATE_VERSION;
  // A result is written completely or not at all.
  common::write_json(result, folder / "result.json.part");
  fs::rename(folder / "result.json.part", folder / "result.json");
}

}  // namespace palpate::studies
