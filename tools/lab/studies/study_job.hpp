#pragma once

#include <filesystem>
#include <string>

#include "tools/lab/studies/sensing_recording.hpp"
#include "tools/lab/studies/study_plan.hpp"

namespace palpate::studies {

/// Runs one job: simulator and daemon in lock-step, or in real time if the job requests it; scores
/// it on the plant's ground truth; leaves images, the programs' output and result.json, which
/// carries `inputs_hash`, in `folder`. The logs are deleted once scored, unless `keep_logs`. Throws
/// RunFailed and any exception of scoring; the logs are then kept.
void run_study_job(const StudyJob& job, const std::string& inputs_hash,
                   const std::filesystem::path& folder, bool keep_logs);

/// The part of a job that is simulated once for all methods: its scene, by level and seed.
SensingScene scene_of(const StudyJob& job);

/// Name of the recording of scene_of(), which is that of its folder.
std::string recording_of(const StudyJob& job);

/// Hash of all inputs of a method's result on a recording: the recording's own hash, the method's
/// configuration with the files that it names, the programs that replay and score, the scoring
/// settings, and whether its states are drawn.
std::string hash_of_replay(const StudyJob& job, const std::string& recording_hash, bool pictures);

/// Replays the recording in `recorded` with the job's method, scores it on the plant's ground truth
/// and writes result.json (with images of the states, if requested) to `folder`. Throws RunFailed
/// and std::runtime_error.
void run_replayed_job(const StudyJob& job, const std::string& inputs_hash,
                      const std::filesystem::path& recorded, const std::filesystem::path& folder,
                      bool pictures);

}  // namespace palpate::studies
