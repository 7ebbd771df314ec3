#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tools/lab/scores/node_belief.hpp"
#include "tools/lab/scores/shape_score.hpp"
#include "tools/lab/studies/discrepancy_reports.hpp"
#include "tools/lab/studies/discrepancy_world.hpp"
#include "tools/lab/studies/discrepancy_wrench.hpp"

namespace palpate::studies {

/// What the pose of the hand alone gives in a world: the estimate is compared with it.
struct PoseAlone {
  std::vector<scores::ShapeErrorSample> errors;  // times in s since the start of the scene
  std::vector<estimate_t> estimates;             // of which the predicted wrenches are used
};

/// `log`: truth, and SHAPE and ESTIMATE of pose alone; its estimates are taken. X_OP: pose of the
/// plant's O (P) in palpated's O. Throws std::runtime_error if the log lacks truth or shape.
PoseAlone pose_alone(log::RunLog& log, const math::Pose& X_OP);

/// An estimate in a world that its model does not describe. Times in s since the start of the
/// scene.
struct DiscrepancyScore {
  double begin = 0, end_of_log = 0;  // scored time: since the motion begins
  std::optional<double> onset, end;  // of the discrepancy; empty: it never began, or stays
  /// Since when, from the onset on, the mean or the largest error of the nodes exceeds 3 mm.
  std::optional<double> mean_passed, largest_passed;
  double mean_error = 0, largest_error = 0;  // m, most from the onset to the end
  std::vector<DoubtReport> reports;
  std::optional<double> reported;  // first report from the onset on
  std::string reason;
  int false_reports = 0;  // that begin and end before the onset, or without any
  /// Shares of the nodes within their reported 95 % region: while a discrepancy is reported; while
  /// the largest error exceeds 3 mm and none is.
  scores::NodeBelief reported_belief, unreported_belief;
  /// s from the end of the discrepancy until the largest error stays below 3 mm; until no report is
  /// left. Empty: never, or the discrepancy stays.
  std::optional<double> recovered, cleared;
  /// s from the end of the discrepancy until the mean error is for the first time, and until it
  /// stays, at most 0.1 mm above that of pose alone.
  std::optional<double> reached_pose_alone, stays_at_pose_alone;
  /// m, mean over time of the nodes' mean error, and the same of pose alone.
  double average_error = 0;
  std::optional<double> average_of_pose_alone;
  /// Largest |difference| / deviation of DISCREPANCY from the onset until 0.5 s after the largest
  /// error passes 3 mm.
  std::optional<double> significance;
  /// True wrench minus that of pose alone in the same time; without a discrepancy in all.
  std::optional<WrenchError> wrench_error;
  /// Causes (discrepancy_t) 2 s after the report, and at the end of the discrepancy or the log.
  std::vector<int> early_ranking, late_ranking;
};

/// `log`: truth, SHAPE, ESTIMATE, HEALTH and, if there is any, UNKNOWN_CONTACT and DISCREPANCY;
/// `pose`: of the same recording. X_OP: pose of the plant's O (P) in palpated's O. Throws
/// std::runtime_error if the log lacks truth or estimate.
DiscrepancyScore score_discrepancy(const DiscrepancyWorld& world, const log::RunLog& log,
                                   const PoseAlone& pose, const math::Pose& X_OP);

/// Times of the reports in s since `start` (us), that of the scene.
nlohmann::json to_json(const DiscrepancyScore& score, std::int64_t start);

}  // namespace palpate::studies
