#include "tools/lab/studies/discrepancy_score.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "tools/common/output_files.hpp"
#include "tools/lab/studies/discrepancy_ranking.hpp"
#include "tools/lab/studies/discrepancy_touch.hpp"

namespace palpate::studies {
namespace {

using Json = nlohmann::json;
using scores::ShapeErrorSample;

constexpr double kLimit = 3e-3;         // m, an error that must be reported
constexpr double kStays = 0.1;          // s before the end of the log, of a contact that stays
constexpr double kNoWorse = 0.1e-3;     // m, than pose alone after the end
constexpr double kRanked = 2;           // s after a report
constexpr double kSameTime = 5e-3;      // s, of two estimates' shapes
constexpr double kShapePeriod = 10e-3;  // s

/// Sample at that time or soon after; nullptr: there is none.
const ShapeErrorSample* sample_at(const std::vector<ShapeErrorSample>& samples, double time) {
  const auto after =
      std::lower_bound(samples.begin(), samples.end(), time - kSameTime,
                       [](const ShapeErrorSample& sample, double t) { return sample.time < t; });
  if (after == samples.end() || after->time > time + kShapePeriod + kSameTime) return nullptr;
  return &*after;
}

/// Columns of rounded numbers.
Json json_of(const std::vector<TestedWrench>& tests) {
  Json times = Json::array(), errors = Json::array(), significances = Json::array(),
       tests_of_all = Json::array();
  const auto rounded = [](double value) { return 1e-3 * std::round(1e3 * value); };
  for (const TestedWrench& test : tests) {
    times.push_back(rounded(test.time));
    errors.push_back(rounded(1e3 * test.largest_error));
    significances.push_back(rounded(test.significance));
    tests_of_all.push_back(rounded(test.of_threshold));
  }
  return {{"time_s", times},
          {"largest_error_mm", errors},
          {"significance", significances},
          {"test_of_threshold", tests_of_all}};
}

double significance_of(const discrepancy_t& report) {
  double largest = 0;
  for (int hand = 0; hand < std::clamp(report.grasp_count, 0, 2); ++hand)
    for (int i = 0; i < 6; ++i) {
      if (!(report.deviation[hand][i] > 0)) continue;
      largest = std::max(largest, std::abs(report.difference[hand][i]) / report.deviation[hand][i]);
    }
  return largest;
}

class Scoring {
 public:
  Scoring(const DiscrepancyWorld& world, const log::RunLog& log,
          const std::vector<ShapeErrorSample>& pose_alone, const math::Pose& X_OP)
      : world_(world),
        log_(log),
        pose_alone_(pose_alone),
        X_OP_(X_OP),
        errors_(shape_errors(log, X_OP)),
        start_(log.truths.front().utime) {
    score_.begin = world.begin;
    score_.end_of_log = time(log.shapes.back().utime);
    score_.reports = doubt_reports(log, utime(world.begin));
  }

  DiscrepancyScore score() {
    find_discrepancy();
    score_errors();
    score_reports();
    score_coverage();
    score_tests();
    score_rankings();
    compare_with_pose_alone();
    if (score_.end) score_recovery();
    return score_;
  }

 private:
  double time(std::int64_t utime) const { return 1e-6 * static_cast<double>(utime - start_); }
  std::int64_t utime(double seconds) const {
    return start_ + static_cast<std::int64_t>(std::llround(1e6 * seconds));
  }

  void find_discrepancy() {
    if (world_.kind == "none") return;
    if (!world_.obstacle) {
      score_.onset = world_.onset;
      if (std::isfinite(world_.end)) score_.end = world_.end;
      return;
    }
    const std::optional<TouchTimes> touch = find_touch(log_, *world_.obstacle);
    if (!touch) return;
    score_.onset = time(touch->first);
    if (time(touch->last) < time(log_.truths.back().utime) - kStays) score_.end = time(touch->last);
  }

  /// Without a discrepancy its effects count from the beginning.
  double onset() const { return score_.onset.value_or(score_.begin); }
  double end() const { return score_.end.value_or(score_.end_of_log); }

  void score_errors() {
    for (const ShapeErrorSample& sample : errors_) {
      if (sample.time < onset() || sample.time > end()) continue;
      score_.mean_error = std::max(score_.mean_error, sample.mean);
      score_.largest_error = std::max(score_.largest_error, sample.maximum);
      if (!score_.mean_passed && sample.mean > kLimit) score_.mean_passed = sample.time;
      if (!score_.largest_passed && sample.maximum > kLimit) score_.largest_passed = sample.time;
    }
  }

  void score_reports() {
    const double first = score_.onset.value_or(HUGE_VAL);
    for (const DoubtReport& report : score_.reports)
      if (time(report.end) < first) ++score_.false_reports;
    if (!score_.onset) return;
    const DoubtReport* report = reported_at(score_.reports, utime(*score_.onset));
    if (report == nullptr) return;
    score_.reported = std::max(time(report->begin), *score_.onset);
    score_.reason = report->reason;
  }

  void score_coverage() {
    scores::visit_node_errors(log_, X_OP_,
                              [this](const shape_t& shape, const Eigen::RowVectorXd& error) {
                                if (is_reported(score_.reports, shape.utime))
                                  score_.reported_belief.add(shape, error);
                                else if (error.maxCoeff() > kLimit)
                                  score_.unreported_belief.add(shape, error);
                              });
  }

  void score_tests() {
    for (const discrepancy_t& report : log_.discrepancies) {
      if (time(report.utime) < score_.begin) continue;
      const ShapeErrorSample* sample = sample_at(errors_, time(report.utime));
      if (sample == nullptr) continue;
      const double of_threshold = report.threshold > 0 ? report.test / report.threshold : 0;
      score_.tests.push_back(
          {time(report.utime), sample->maximum, significance_of(report), of_threshold});
    }
  }

  void score_rankings() {
    if (!score_.reported) return;
    const auto ranking = [this](double at) {
      return ranking_at(log_, score_.reports, utime(*score_.onset), utime(at));
    };
    score_.early_ranking = ranking(*score_.reported + kRanked);
    score_.late_ranking = ranking(end());
  }

  void compare_with_pose_alone() {
    double of_pose = 0;
    int count = 0, compared = 0;
    for (const ShapeErrorSample& sample : errors_) {
      if (sample.time < score_.begin) continue;
      score_.average_error += sample.mean;
      ++count;
      const ShapeErrorSample* pose = sample_at(pose_alone_, sample.time);
      if (pose == nullptr) continue;
      of_pose += pose->mean;
      ++compared;
    }
    if (count > 0) score_.average_error /= count;
    if (compared > 0) score_.average_of_pose_alone = of_pose / compared;
  }

  void score_recovery() {
    std::optional<double> below, no_worse;
    for (const ShapeErrorSample& sample : errors_) {
      const double since = sample.time - *score_.end;
      if (since < 0) continue;
      if (sample.maximum > kLimit)
        below.reset();
      else if (!below)
        below = since;
      const ShapeErrorSample* pose = sample_at(pose_alone_, sample.time);
      if (pose == nullptr) continue;
      if (sample.mean > pose->mean + kNoWorse) {
        no_worse.reset();
        continue;
      }
      if (!no_worse) no_worse = since;
      if (!score_.reached_pose_alone) score_.reached_pose_alone = since;
    }
    score_.recovered = below;
    score_.stays_at_pose_alone = no_worse;
    double last = *score_.end;
    for (const DoubtReport& report : score_.reports)
      if (time(report.end) > last) last = time(report.end);
    if (last < score_.end_of_log - 0.05) score_.cleared = last - *score_.end;
  }

  const DiscrepancyWorld& world_;
  const log::RunLog& log_;
  const std::vector<ShapeErrorSample>& pose_alone_;
  const math::Pose X_OP_;
  const std::vector<ShapeErrorSample> errors_;
  const std::int64_t start_;
  DiscrepancyScore score_;
};

Json names_of(const std::vector<int>& causes) {
  Json names = Json::array();
  for (const int cause : causes) names.push_back(cause_name(cause));
  return names;
}

}  // namespace

std::vector<ShapeErrorSample> shape_errors(const log::RunLog& log, const math::Pose& X_OP) {
  std::vector<ShapeErrorSample> errors = scores::score_shape(log, X_OP).samples;
  const double shift =
      1e-6 * static_cast<double>(log.shapes.front().utime - log.truths.front().utime);
  for (ShapeErrorSample& error : errors) error.time += shift;
  return errors;
}

DiscrepancyScore score_discrepancy(const DiscrepancyWorld& world, const log::RunLog& log,
                                   const std::vector<ShapeErrorSample>& pose_alone,
                                   const math::Pose& X_OP) {
  if (log.truths.empty() || log.shapes.empty() || log.estimates.empty())
    throw std::runtime_error("the log holds no truth or no estimate");
  return Scoring(world, log, pose_alone, X_OP).score();
}

nlohmann::json to_json(const DiscrepancyScore& score, std::int64_t start) {
  const auto seconds = [start](std::int64_t utime) {
    return 1e-6 * static_cast<double>(utime - start);
  };
  Json reports = Json::array();
  for (const DoubtReport& report : score.reports)
    reports.push_back({{"begin_s", seconds(report.begin)},
                       {"end_s", seconds(report.end)},
                       {"reason", report.reason}});
  const double free = std::min(score.onset.value_or(score.end_of_log), score.end_of_log);
  return {{"onset_s", common::or_null(score.onset)},
          {"end_s", common::or_null(score.end)},
          {"end_of_log_s", score.end_of_log},
          {"free_air_s", std::max(0.0, free - score.begin)},
          {"mean_error_passed_s", common::or_null(score.mean_passed)},
          {"largest_error_passed_s", common::or_null(score.largest_passed)},
          {"mean_error_mm", 1e3 * score.mean_error},
          {"largest_error_mm", 1e3 * score.largest_error},
          {"average_error_mm", 1e3 * score.average_error},
          {"average_error_of_pose_alone_mm", common::or_null(score.average_of_pose_alone, 1e3)},
          {"reports", reports},
          {"reported_s", common::or_null(score.reported)},
          {"reason", score.reason},
          {"false_reports", score.false_reports},
          {"covered_while_reported_percent", common::or_null(score.reported_belief.covered(), 100)},
          {"nodes_while_reported", score.reported_belief.count()},
          {"nodes_inside_while_reported", score.reported_belief.inside()},
          {"covered_while_wrong_and_unreported_percent",
           common::or_null(score.unreported_belief.covered(), 100)},
          {"recovered_s", common::or_null(score.recovered)},
          {"cleared_s", common::or_null(score.cleared)},
          {"reached_pose_alone_s", common::or_null(score.reached_pose_alone)},
          {"stays_at_pose_alone_s", common::or_null(score.stays_at_pose_alone)},
          {"tests", json_of(score.tests)},
          {"ranking_2s_after_report", names_of(score.early_ranking)},
          {"ranking_at_the_end", names_of(score.late_ranking)}};
}

}  // namespace palpate::studies
