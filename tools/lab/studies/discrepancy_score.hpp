#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tools/lab/scores/node_belief.hpp"
#include "tools/lab/scores/shape_score.hpp"
#include "tools/lab/studies/discrepancy_reports.hpp"
#include "tools/lab/studies/discrepancy_world.hpp"

namespace palpate::studies {

/// Errors of SHAPE, with times in s since the start of the scene. X_OP: pose of the plant's O (P)
/// in palpated's O. Throws std::runtime_error if the log lacks truth or shape.
std::vector<scores::ShapeErrorSample> shape_errors(const log::RunLog& log, const math::Pose& X_OP);

/// A test of the wrenches.
struct TestedWrench {
  double time = 0;           // s
  double largest_error = 0;  // m, of a node
  double significance = 0;   // largest |difference| / deviation of DISCREPANCY
  double of_threshold = 0;   // DISCREPANCY's test divided by its threshold
};

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
  std::vector<TestedWrench> tests;  // since the motion began
  /// Causes (discrepancy_t) 2 s after the report, and at the end of the discrepancy or the log.
  std::vector<int> early_ranking, late_ranking;
};

/// `log`: truth, SHAPE, ESTIMATE, HEALTH and, if there is any, UNKNOWN_CONTACT and DISCREPANCY;
/// `pose_alone`: errors of the shape by the pose alone in the same recording, or none. X_OP: pose
/// of the plant's O (P) in palpated's O. Throws std::runtime_error if the log lacks truth or
/// estimate.
DiscrepancyScore score_discrepancy(const DiscrepancyWorld& world, const log::RunLog& log,
                                   const std::vector<scores::ShapeErrorSample>& pose_alone,
                                   const math::Pose& X_OP);

/// Times of the reports in s since `start` (us), that of the scene.
nlohmann::json to_json(const DiscrepancyScore& score, std::int64_t start);

}  // namespace palpate::studies
