#include "tools/lab/scores/belief_score.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "tools/lab/scores/node_belief.hpp"

namespace palpate::scores {
namespace {

using Json = nlohmann::json;

constexpr std::int64_t kModulusEach = 100000;  // us
constexpr double kMoves = 1e-4;                // m or, of the quaternion, 1 in that time
constexpr double kSoon = 3;                    // s of motion within which E must be identified

double seconds_of(std::int64_t microseconds) { return static_cast<double>(microseconds) * 1e-6; }

void score_deviations(const log::RunLog& run, const math::Pose& X_OP, BeliefScore& score) {
  NodeBelief belief;
  visit_node_errors(run, X_OP, [&belief](const shape_t& shape, const Eigen::RowVectorXd& error) {
    belief.add(shape, error);
  });
  score.covered = belief.covered();
  score.deviation = belief.mean_deviation();
}

bool has_moved(const estimate_t& from, const estimate_t& to) {
  double way = 0;
  for (int g = 0; g < to.grasp_count; ++g) {
    for (int i = 0; i < 3; ++i)
      way = std::max(way, std::abs(to.grasp_position[g][i] - from.grasp_position[g][i]));
    for (int i = 0; i < 4; ++i)
      way = std::max(way, std::abs(to.grasp_quaternion[g][i] - from.grasp_quaternion[g][i]));
  }
  return way > kMoves;
}

void score_estimates(const log::RunLog& run, BeliefScore& score) {
  const std::int64_t start = run.shapes.front().utime;
  std::int64_t next = start;
  long with_contact = 0;
  bool estimated = false;
  double moved = 0;
  const estimate_t* before = nullptr;
  for (const estimate_t& estimate : run.estimates) {
    if (reports_contact(estimate)) {
      ++with_contact;
      if (!score.first_contact) score.first_contact = seconds_of(estimate.utime - start);
    }
    if (estimate.utime < next) continue;
    next = estimate.utime + kModulusEach;
    estimated |= estimate.log_young_modulus_deviation >= 0;
    if (before != nullptr && has_moved(*before, estimate))
      moved += seconds_of(estimate.utime - before->utime);
    before = &estimate;
    score.modulus.push_back({seconds_of(estimate.utime - start),
                             std::exp(estimate.log_young_modulus),
                             estimate.log_young_modulus_deviation, moved});
  }
  if (!estimated) score.modulus.clear();
  if (!run.estimates.empty())
    score.contact_share =
        static_cast<double>(with_contact) / static_cast<double>(run.estimates.size());
}

}  // namespace

BeliefScore score_belief(const log::RunLog& run, const math::Pose& X_OP) {
  if (run.shapes.empty()) throw std::runtime_error("the log holds no SHAPE");
  BeliefScore score;
  score_deviations(run, X_OP, score);
  score_estimates(run, score);
  return score;
}

nlohmann::json to_json(const BeliefScore& belief) {
  Json json{
      {"unknown_contact_percent_of_time", 100 * belief.contact_share},
      {"first_unknown_contact_s", belief.first_contact ? Json(*belief.first_contact) : Json()}};
  if (belief.covered) {
    json["within_95_percent_interval"] = 100 * *belief.covered;
    json["mean_deviation_mm"] = 1e3 * belief.deviation;
  }
  if (belief.modulus.empty()) return json;
  json["young_modulus_kpa"] = 1e-3 * belief.modulus.back().young_modulus;
  json["young_modulus_deviation_percent"] = 100 * belief.modulus.back().log_deviation;
  for (const BeliefScore::Modulus& sample : belief.modulus) {
    if (sample.moved >= kSoon && !json.contains("young_modulus_in_3s_of_motion_kpa"))
      json["young_modulus_in_3s_of_motion_kpa"] = 1e-3 * sample.young_modulus;
    json["curve"]["time_s"].push_back(sample.time);
    json["curve"]["young_modulus_kpa"].push_back(1e-3 * sample.young_modulus);
    json["curve"]["log_deviation"].push_back(sample.log_deviation);
  }
  return json;
}

}  // namespace palpate::scores
