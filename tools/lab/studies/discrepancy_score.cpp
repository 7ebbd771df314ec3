#include "tools/lab/studies/discrepancy_score.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "tools/common/output_files.hpp"
#include "tools/lab/scores/shape_score.hpp"
#include "tools/lab/scores/truth_points.hpp"

namespace palpate::studies {
namespace {

using Json = nlohmann::json;

constexpr double kLimit = 3e-3;    // m, an error that must be reported
constexpr double kTouch = 0.3e-3;  // m, between a node and an obstacle in contact
constexpr double kBall = 2.7955;   // sqrt of the 95 % quantile of chi-squared, 3 degrees

/// Shares of nodes.
struct Coverage {
  long inside = 0, count = 0;
  std::optional<double> share() const {
    if (count == 0) return std::nullopt;
    return static_cast<double>(inside) / static_cast<double>(count);
  }
};

class Scoring {
 public:
  Scoring(const DiscrepancyWorld& world, const log::RunLog& log, const math::Pose& X_OP)
      : world_(world),
        log_(log),
        X_OP_(X_OP),
        shape_(scores::score_shape(log, X_OP)),
        reports_(doubt_reports(log)),
        start_(log.truths.front().utime),
        shift_(time(log.shapes.front().utime)) {}

  DiscrepancyScore score() {
    find_discrepancy();
    score_errors();
    score_reports();
    score_coverage();
    if (score_.end) score_recovery();
    return score_;
  }

 private:
  double time(std::int64_t utime) const { return 1e-6 * static_cast<double>(utime - start_); }
  std::int64_t utime(double seconds) const {
    return start_ + static_cast<std::int64_t>(std::llround(1e6 * seconds));
  }
  double end_of_log() const { return time(log_.shapes.back().utime); }

  void find_discrepancy() {
    if (world_.kind == "none") return;
    if (!world_.obstacle) {
      score_.onset = world_.onset;
      if (std::isfinite(world_.end)) score_.end = world_.end;
      return;
    }
    double last = 0;
    for (const shape_t& truth : log_.truths) {
      const Eigen::Matrix3Xd nodes = log::positions(truth);
      const bool touches = [&] {
        for (int i = 0; i < nodes.cols(); ++i)
          if (world_.obstacle->distance(nodes.col(i)) < kTouch) return true;
        return false;
      }();
      if (!touches) continue;
      last = time(truth.utime);
      if (!score_.onset) score_.onset = last;
    }
    if (score_.onset && last < time(log_.truths.back().utime) - 0.1) score_.end = last;
  }

  /// Without a discrepancy its effects count from the start.
  double onset() const { return score_.onset.value_or(0); }
  double end() const { return score_.end.value_or(end_of_log()); }

  void score_errors() {
    for (const scores::ShapeErrorSample& sample : shape_.samples) {
      const double now = sample.time + shift_;
      if (now < onset() || now > end()) continue;
      score_.mean_error = std::max(score_.mean_error, sample.mean);
      score_.largest_error = std::max(score_.largest_error, sample.maximum);
      if (!score_.mean_passed && sample.mean > kLimit) score_.mean_passed = now;
      if (!score_.largest_passed && sample.maximum > kLimit) score_.largest_passed = now;
    }
  }

  void score_reports() {
    const double first = score_.onset.value_or(HUGE_VAL);
    for (const DoubtReport& report : reports_) score_.false_report |= time(report.end) < first;
    if (!score_.onset) return;
    const DoubtReport* report = reported_at(reports_, utime(*score_.onset));
    if (report == nullptr) return;
    score_.reported = std::max(time(report->begin), *score_.onset);
    score_.reason = report->reason;
  }

  bool is_reported(std::int64_t now) const {
    return std::any_of(reports_.begin(), reports_.end(), [now](const DoubtReport& report) {
      return report.begin <= now && now <= report.end;
    });
  }

  void score_coverage() {
    const log::MeshMessage estimate = log::assemble(log_.shape_chunks),
                           plant = log::assemble(log_.truth_chunks);
    const scores::TruthPoints points(plant, estimate, estimate.nodes, X_OP_);
    const log::PlantMotion motion(log_.truths);
    Eigen::Matrix3Xd truth;
    Coverage reported, unreported;
    for (const shape_t& shape : log_.shapes) {
      if (shape.mesh_hash != estimate.hash || shape.node_count != estimate.nodes.cols()) continue;
      if (shape.deviation_count != shape.node_count || !motion.at(shape.utime, truth)) continue;
      const Eigen::RowVectorXd error = (log::positions(shape) - points.at(truth)).colwise().norm();
      const bool is_now = is_reported(shape.utime);
      if (!is_now && error.maxCoeff() <= kLimit) continue;
      Coverage& coverage = is_now ? reported : unreported;
      for (int i = 0; i < shape.node_count; ++i) {
        if (!(shape.deviation[i] > 0)) continue;  // fixed, or not observable
        coverage.inside += error[i] <= kBall * shape.deviation[i] ? 1 : 0;
        ++coverage.count;
      }
    }
    score_.covered = reported.share();
    score_.covered_unreported = unreported.share();
  }

  void score_recovery() {
    std::optional<double> since;
    for (const scores::ShapeErrorSample& sample : shape_.samples) {
      const double now = sample.time + shift_;
      if (now < *score_.end) continue;
      if (sample.maximum > kLimit)
        since.reset();
      else if (!since)
        since = now - *score_.end;
    }
    score_.recovered = since;
    double last = *score_.end;
    for (const DoubtReport& report : reports_)
      if (time(report.end) > last) last = time(report.end);
    if (last < end_of_log() - 0.05) score_.cleared = last - *score_.end;
  }

  const DiscrepancyWorld& world_;
  const log::RunLog& log_;
  const math::Pose X_OP_;
  const scores::ShapeScore shape_;
  const std::vector<DoubtReport> reports_;
  const std::int64_t start_;
  const double shift_;  // s, from the start of the scene to the first shape
  DiscrepancyScore score_;
};

}  // namespace

std::vector<DoubtReport> doubt_reports(const log::RunLog& log) {
  std::vector<DoubtReport> reports;
  bool is_open = false;
  for (const estimate_t& estimate : log.estimates) {
    const bool doubts = estimate.status == estimate_t::STATUS_DEGRADED;
    if (doubts && !is_open) {
      reports.push_back({estimate.utime, estimate.utime, ""});
      // HEALTH follows ten times a second.
      for (const health_t& health : log.health) {
        if (health.utime < estimate.utime) continue;
        if (health.state == health_t::STATE_DEGRADED)
          reports.back().reason = reinterpret_cast<const char*>(health.reason);
        break;
      }
    }
    if (doubts) reports.back().end = estimate.utime;
    is_open = doubts;
  }
  return reports;
}

const DoubtReport* reported_at(const std::vector<DoubtReport>& reports, std::int64_t from) {
  const auto found = std::find_if(reports.begin(), reports.end(),
                                  [from](const DoubtReport& report) { return report.end >= from; });
  return found == reports.end() ? nullptr : &*found;
}

DiscrepancyScore score_discrepancy(const DiscrepancyWorld& world, const log::RunLog& log,
                                   const math::Pose& X_OP) {
  if (log.truths.empty() || log.shapes.empty() || log.estimates.empty())
    throw std::runtime_error("the log holds no truth or no estimate");
  return Scoring(world, log, X_OP).score();
}

nlohmann::json to_json(const DiscrepancyScore& score) {
  return {{"onset_s", common::or_null(score.onset)},
          {"end_s", common::or_null(score.end)},
          {"mean_error_passed_s", common::or_null(score.mean_passed)},
          {"largest_error_passed_s", common::or_null(score.largest_passed)},
          {"mean_error_mm", 1e3 * score.mean_error},
          {"largest_error_mm", 1e3 * score.largest_error},
          {"reported_s", common::or_null(score.reported)},
          {"reason", score.reason},
          {"false_report", score.false_report},
          {"covered_while_reported_percent", common::or_null(score.covered, 100)},
          {"covered_while_wrong_and_unreported_percent",
           common::or_null(score.covered_unreported, 100)},
          {"recovered_s", common::or_null(score.recovered)},
          {"cleared_s", common::or_null(score.cleared)}};
}

}  // namespace palpate::studies
