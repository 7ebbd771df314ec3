#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tools/lab/studies/discrepancy_world.hpp"
#include "tools/log/log_reader.hpp"

namespace palpate::studies {

/// A time in which the estimator reports that its model does not explain what it measures.
struct DoubtReport {
  std::int64_t begin = 0, end = 0;  // us; end: of the log, if it lasts until then
  std::string reason;               // as HEALTH gives it; empty if the log holds none
};

/// From the status of the estimation slot in ESTIMATE.
std::vector<DoubtReport> doubt_reports(const log::RunLog& log);

/// Start of the first report at or after `from` (us), or of one that lasts then; nullptr: none.
const DoubtReport* reported_at(const std::vector<DoubtReport>& reports, std::int64_t from);

/// An estimate in a world that its model does not describe. Times in s since the start of the
/// scene.
struct DiscrepancyScore {
  std::optional<double> onset, end;  // of the discrepancy; empty: it never began, or stays
  /// Since when, from the onset on, the mean or the largest error of the nodes exceeds 3 mm.
  std::optional<double> mean_passed, largest_passed;
  double mean_error = 0, largest_error = 0;  // m, most from the onset to the end
  std::optional<double> reported;            // first report from the onset on
  std::string reason;
  bool false_report = false;  // a report that begins and ends before the onset, or without any
  /// Shares of the nodes within their reported 95 % region: while a discrepancy is reported; while
  /// the largest error exceeds 3 mm and none is.
  std::optional<double> covered, covered_unreported;
  /// s from the end of the discrepancy until the largest error stays below 3 mm; until no report is
  /// left. Empty: never, or the discrepancy stays.
  std::optional<double> recovered, cleared;
};

/// `log`: truth, SHAPE, ESTIMATE and HEALTH. X_OP: pose of the plant's O (P) in palpated's O.
/// Throws std::runtime_error if the log lacks truth or estimate.
DiscrepancyScore score_discrepancy(const DiscrepancyWorld& world, const log::RunLog& log,
                                   const math::Pose& X_OP);

nlohmann::json to_json(const DiscrepancyScore& score);

}  // namespace palpate::studies
