#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "tools/lab/scores/feature_score.hpp"
#include "tools/lab/scores/loop_score.hpp"
#include "tools/lab/scores/shape_score.hpp"

namespace palpate::scores {

/// Contact and force on a real recording, compared with its own force-torque sensor.
struct RecordingScore {
  double duration = 0;                                 // s of contact
  double force_rms = 0;                                // N, vector error
  double force_magnitude_rms = 0;                      // N
  double true_force_rms = 0;                           // N, of the ground truth itself
  Eigen::Vector3d location = Eigen::Vector3d::Zero();  // m, in O, mean where |F| is largest
  double largest_displacement = 0;                     // m, of the estimated shape
};

/// Results of one run.
struct ScoredRun {
  std::string stage;     // sensing, control, recording
  std::string name;      // method or target
  std::string mismatch;  // level of model error; empty if not applicable
  std::optional<ShapeScore> shape;
  std::optional<FeatureScore> feature;
  std::optional<LoopScore> loop;  // absent for a run that was not in real time
  std::optional<CommandScore> commands;
  std::optional<RecordingScore> recording;
  std::vector<std::string> missed;  // bounds that were missed
  std::string failure;              // reason for a missing score; empty if there is one
  std::string skipped;              // reason why the run did not take place
};

/// One table of all runs, followed by missed bounds and failures.
void print_report(const std::vector<ScoredRun>& runs, std::ostream& out);

nlohmann::json to_json(const ScoredRun& run);

}  // namespace palpate::scores
