#pragma once

#include "tools/lab/runs/live_run.hpp"
#include "tools/lab/scores/report.hpp"

namespace palpate::scores {

/// Limits with which a run's commands are compared.
struct Gate {
  control::GateLimits limits;
  double period = 1e-3;  // s, of the daemon's loop
};

/// From the configuration with its overrides, as palpated reads it. Throws config::Error.
Gate gate_of(const runs::RunPlan& plan);
Gate gate_of(const std::filesystem::path& configuration, const std::vector<std::string>& overrides);

/// Adds every score that the log supports: shape, feature, loop, commands. Commands beyond the
/// gate's limits and a fault are entered as missed bounds. Throws std::runtime_error if data are
/// missing. X_OP: pose of the plant's O (P) in palpated's O.
void score_into(ScoredRun& scored, const log::RunLog& log, const Gate& gate,
                const runs::FeatureDefinition* steered = nullptr,
                const math::Pose& X_OP = math::Pose::Identity());

/// Adds a missed bound if fewer poses were held than `scene` contains.
void check_poses(ScoredRun& scored, const std::filesystem::path& scene);

struct ScoreOptions {
  std::filesystem::path control;
  std::filesystem::path housekeeping;
  std::filesystem::path scene;          // of palpate-sim; empty: held poses are not counted
  std::filesystem::path configuration;  // of palpated; empty: commands are not checked
  std::filesystem::path json;           // empty: none
};

/// Scores recorded logs, prints the table and returns the exit code.
int run_score(const ScoreOptions& options);

}  // namespace palpate::scores
