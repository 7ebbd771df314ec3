#include "tools/lab/scores/feature_score.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/math/constants.hpp"
#include "tools/lab/scores/truth_points.hpp"

namespace palpate::scores {
namespace {

using math::kDegree;
constexpr double kRest = 0.5;  // s at the end of a run over which the steady-state error is taken

/// The last target of the log, at its first transmission.
const shape_target_t& first_of_last_revision(const std::vector<shape_target_t>& targets) {
  const std::int32_t revision = targets.back().revision;
  return *std::find_if(targets.begin(), targets.end(), [revision](const shape_target_t& target) {
    return target.revision == revision;
  });
}

void score_end(FeatureScore& score) {
  double distance = 0, angle = 0, size = 0;
  int count = 0;
  for (const FeatureErrorSample& sample : score.samples) {
    if (sample.time < score.samples.back().time - kRest) continue;
    distance += sample.distance;
    angle += sample.angle;
    size += sample.size;
    ++count;
  }
  score.rest_distance = distance / count;
  score.rest_angle = angle / count;
  score.rest_size = size / count;
}

/// The daemon's own estimate, decimated: the loop publishes far more than a plot can show.
void add_estimate(FeatureScore& score, const std::vector<feature_t>& features,
                  const shape_target_t& target, const runs::FeatureOnPoints& on_points) {
  constexpr std::int64_t kPeriod = 10000;  // us
  std::int64_t next = 0;
  for (const feature_t& feature : features) {
    if (feature.revision != target.revision || feature.error_count < 1) continue;
    const auto vector = [&score](const double(&numbers)[32], int count) -> Eigen::VectorXd {
      return Eigen::Map<const Eigen::VectorXd>(numbers,
                                               score.kind == "points" ? count / 3 * 3 : count);
    };
    // A contour of more numbers than FEATURE holds cannot be evaluated from some of them.
    if (score.kind == "fourier_contour" && feature.error_count < target.value_count) continue;
    const Eigen::VectorXd error = vector(feature.error, feature.error_count);
    const Eigen::VectorXd unreachable = vector(feature.unreachable, feature.error_count);
    score.estimated_distance = on_points.distance(error);
    score.estimated_size = on_points.size(error);
    score.unreachable = on_points.distance(unreachable);
    score.unreachable_size = on_points.size(unreachable);
    if (feature.utime < next) continue;
    next = feature.utime + kPeriod;
    FeatureErrorSample sample;
    sample.time = static_cast<double>(feature.utime - target.utime) * 1e-6;
    sample.position = on_points.place(vector(feature.value, feature.value_count));
    sample.distance = score.estimated_distance;
    sample.angle = on_points.angle(error);
    sample.size = score.estimated_size;
    score.estimated.push_back(sample);
  }
}

double path_length(const std::vector<FeatureErrorSample>& samples) {
  double path = 0;
  for (std::size_t i = 1; i < samples.size(); ++i)
    path += (samples[i].position - samples[i - 1].position).norm();
  return path;
}

}  // namespace

std::optional<double> time_to_stay_within(const std::vector<FeatureErrorSample>& samples,
                                          double distance, double angle) {
  std::optional<double> since;
  for (const FeatureErrorSample& sample : samples) {
    const bool within = sample.distance <= distance && sample.angle <= angle;
    if (!within) since.reset();
    if (within && !since) since = sample.time;
  }
  return since;
}

std::optional<double> time_to_stay_within(const std::vector<FeatureErrorSample>& samples,
                                          double size) {
  std::optional<double> since;
  for (const FeatureErrorSample& sample : samples) {
    if (sample.size > size) since.reset();
    if (sample.size <= size && !since) since = sample.time;
  }
  return since;
}

double overshoot(const std::vector<FeatureErrorSample>& samples, const Eigen::Vector3d& target) {
  if (samples.empty()) return 0;
  const Eigen::Vector3d way = target - samples.front().position;
  const double length = way.norm();
  if (length < 1e-9) return 0;
  double furthest = 0;
  for (const FeatureErrorSample& sample : samples)
    furthest = std::max(furthest, (sample.position - target).dot(way) / length);
  return furthest / length;
}

std::optional<FeatureScore> score_feature(const log::RunLog& run,
                                          const runs::FeatureDefinition* steered,
                                          const math::Pose& X_OP) {
  if (run.targets.empty()) return std::nullopt;
  const shape_target_t& message = first_of_last_revision(run.targets);
  if (message.point_count < 1)
    throw std::runtime_error("the target names no rest points: it cannot be scored");
  FeatureScore score;
  score.kind = reinterpret_cast<const char*>(message.kind);
  runs::FeatureDefinition definition;
  if (steered != nullptr && steered->kind == score.kind) definition = *steered;
  definition.kind = score.kind;
  definition.rest_points.clear();
  for (int i = 0; i < message.point_count; ++i)
    definition.rest_points.emplace_back(Eigen::Map<const Eigen::Vector3d>(message.rest_points[i]));
  const runs::FeatureOnPoints feature(definition);
  score.is_distance = feature.is_distance();
  if (message.value_count != feature.value_count())
    throw std::runtime_error("a target with the wrong number of values");
  const Eigen::VectorXd target =
      Eigen::Map<const Eigen::VectorXd>(message.values, message.value_count);
  score.target = feature.place(target);

  const log::MeshMessage plant = log::assemble(run.truth_chunks);
  // Without a mesh of palpated's its dimensions are those of the plant.
  const TruthPoints points(plant,
                           run.shape_chunks.empty() ? plant : log::assemble(run.shape_chunks),
                           feature.rest_points(), X_OP);
  for (const shape_t& truth : run.truths) {
    if (truth.utime < message.utime || truth.node_count != plant.nodes.cols()) continue;
    const Eigen::VectorXd value = feature.value(points.at(log::positions(truth)));
    const Eigen::VectorXd error = feature.error(value, target);
    FeatureErrorSample sample;
    sample.time = static_cast<double>(truth.utime - message.utime) * 1e-6;
    sample.position = feature.place(value);
    sample.distance = feature.distance(error);
    sample.angle = feature.angle(error);
    sample.size = feature.size(error);
    score.samples.push_back(sample);
    if (score.kind == "points")
      score.rest_largest = error.reshaped(3, error.size() / 3).colwise().norm().maxCoeff();
  }
  if (score.samples.empty()) throw std::runtime_error("no TRUTH_SHAPE after the target was sent");
  score.start_distance = score.samples.front().distance;
  score.start_size = score.samples.front().size;
  score_end(score);
  score.within_5mm = time_to_stay_within(score.samples, 5e-3, 1 * kDegree);
  score.within_2mm = time_to_stay_within(score.samples, 2e-3, 0.4 * kDegree);
  score.within_1mm = time_to_stay_within(score.samples, 1e-3, 0.2 * kDegree);
  score.within_twentieth = time_to_stay_within(score.samples, 0.05 * score.start_size);
  score.overshoot = overshoot(score.samples, score.target);
  score.path = path_length(score.samples);
  add_estimate(score, run.features, message, feature);
  return score;
}

}  // namespace palpate::scores
