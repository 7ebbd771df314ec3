#include "tools/lab/studies/study_score.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "core/math/constants.hpp"
#include "tools/lab/runs/feature_on_points.hpp"
#include "tools/lab/scores/truth_points.hpp"

namespace palpate::studies {
namespace {

using Json = nlohmann::json;

using math::kDegree;
constexpr double kWindow = 0.5;     // s before a state over which errors are taken
constexpr double kFinest = 2.5e-3;  // m between the samples of a surface
constexpr double kDots = 8e-3;      // m between the points of a cloud that is not measured
constexpr int kCurvePoints = 250;

std::int64_t microseconds(double seconds) { return static_cast<std::int64_t>(seconds * 1e6); }

std::vector<StudyState> states_of(const StudyJob& job, const scores::ShapeScore& shape) {
  if (!job.states.empty()) return job.states;
  if (job.kind == "control") return {{"end", shape.samples.back().time}};
  std::vector<StudyState> states;
  for (std::size_t i = 0; i < shape.holds.size(); ++i) {
    std::string name = i < job.pose_names.size() ? job.pose_names[i] : "";
    if (name.empty()) name = "pose " + std::to_string(i + 1);
    states.push_back({name, shape.holds[i].end});
  }
  if (states.empty()) throw std::runtime_error("no pose was held");
  return states;
}

Eigen::Matrix3Xd observed(const shape_observation_t& message, const math::Pose& X_WO) {
  const math::Pose X_OW = X_WO.inverse();
  Eigen::Matrix3Xd points(3, message.count);
  for (int i = 0; i < message.count; ++i)
    points.col(i) = X_OW * Eigen::Map<const Eigen::Vector3f>(message.points[i]).cast<double>();
  return points;
}

/// Shapes recorded in a log at a time.
class Shapes {
 public:
  Shapes(const log::RunLog& log, const math::Pose& X_WO, const math::Pose& X_OP)
      : log_(log),
        X_WO_(X_WO),
        X_OP_(X_OP),
        plant_(log::assemble(log.truth_chunks)),
        estimate_(log::assemble(log.shape_chunks)),
        motion_(log.truths) {}

  const log::MeshMessage& plant() const { return plant_; }
  const log::MeshMessage& estimate() const { return estimate_; }

  StateShapes at(std::int64_t utime) const {
    StateShapes shapes;
    const shape_t* estimate = log::latest(log_.shapes, utime);
    if (!motion_.at(utime, shapes.truth.points) || estimate == nullptr ||
        estimate->node_count != estimate_.nodes.cols())
      throw std::runtime_error("the log does not reach the state");
    shapes.truth.points = log::transformed(X_OP_, shapes.truth.points);
    shapes.truth.triangles = plant_.triangles;
    shapes.estimate = {log::positions(*estimate), estimate_.triangles};
    const shape_observation_t* observation = log::latest(log_.observations, utime);
    shapes.camera = observation != nullptr && observation->count > 0;
    shapes.measured = shapes.camera ? observed(*observation, X_WO_)
                                    : scores::sample_surface(shapes.truth, kDots).points;
    return shapes;
  }

 private:
  const log::RunLog& log_;
  const math::Pose X_WO_, X_OP_;
  log::MeshMessage plant_, estimate_;
  log::PlantMotion motion_;
};

std::optional<math::Vector6d> pose_error(const StudyJob& job, const log::RunLog& log,
                                         const Shapes& shapes, const math::Pose& X_OP,
                                         std::int64_t end) {
  if (job.pose_points.empty()) return std::nullopt;
  runs::FeatureDefinition definition;
  definition.kind = "pose";
  definition.rest_points = job.pose_points;
  const runs::FeatureOnPoints feature(definition);
  const scores::TruthPoints points(shapes.plant(), shapes.estimate(), feature.rest_points(), X_OP);
  math::Vector6d sum = math::Vector6d::Zero();
  int count = 0;
  for (const shape_t& truth : log.truths) {
    if (truth.utime <= end - microseconds(kWindow) || truth.utime > end) continue;
    const feature_t* estimate = log::latest(log.features, truth.utime);
    if (estimate == nullptr || estimate->value_count != feature.value_count()) continue;
    const Eigen::Map<const Eigen::VectorXd> value(estimate->value, estimate->value_count);
    sum += feature.error(feature.value(points.at(log::positions(truth))), value);
    ++count;
  }
  if (count == 0) throw std::runtime_error("the log holds no estimated pose");
  return sum / count;
}

void add_node_error(StateScore& state, const scores::ShapeScore& shape) {
  const auto index = [&shape](double time) {
    return static_cast<std::size_t>(
        std::upper_bound(shape.samples.begin(), shape.samples.end(), time,
                         [](double t, const scores::ShapeErrorSample& s) { return t < s.time; }) -
        shape.samples.begin());
  };
  const std::size_t first = index(state.time - kWindow), last = index(state.time);
  if (first >= last) throw std::runtime_error("no estimate before the state " + state.name);
  state.error = scores::summarise(shape.samples, first, last);
  state.displacement = shape.samples[last - 1].displacement;
}

Json json_of(const scores::DistanceSummary& distance) {
  return {{"mean_mm", distance.mean * 1e3},
          {"rms_mm", distance.rms * 1e3},
          {"max_mm", distance.maximum * 1e3}};
}

}  // namespace

std::vector<StateScore> score_states(const StudyJob& job, const log::RunLog& log,
                                     const scores::ShapeScore& shape, const math::Pose& X_WO,
                                     const math::Pose& X_OP) {
  const Shapes shapes(log, X_WO, X_OP);
  const std::int64_t start = log.shapes.front().utime;
  std::vector<StateScore> scores;
  for (const StudyState& wanted : states_of(job, shape)) {
    StateScore state;
    state.name = wanted.name;
    state.time = wanted.time;
    add_node_error(state, shape);
    const std::int64_t utime = start + microseconds(wanted.time);
    state.shapes = shapes.at(utime);
    const draw::TriangleMesh &truth = state.shapes.truth, &estimate = state.shapes.estimate;
    state.surface = scores::surface_distance(truth, estimate, kFinest);
    const double spacing = std::min(kFinest, 0.25 * job.octree_resolution);
    state.octree = scores::octree_agreement(scores::sample_surface(estimate, spacing).points,
                                            scores::sample_surface(truth, spacing).points,
                                            job.octree_resolution);
    if (state.shapes.camera)
      state.camera = scores::summarise_distances(
          scores::distances_to_surface(state.shapes.measured, estimate));
    state.pose_error = pose_error(job, log, shapes, X_OP, utime);
    scores.push_back(std::move(state));
  }
  return scores;
}

nlohmann::json to_json(const StateScore& state, double length) {
  const scores::ErrorSummary& error = state.error;
  const double of_length = 100 / length, of_displacement = 100 / std::max(1e-9, state.displacement);
  Json json{{"name", state.name},
            {"time_s", state.time},
            {"displacement_mm", state.displacement * 1e3},
            {"mean_mm", error.mean * 1e3},
            {"rms_mm", error.rms * 1e3},
            {"max_mm", error.maximum * 1e3},
            {"mean_percent_of_length", error.mean * of_length},
            {"rms_percent_of_length", error.rms * of_length},
            {"max_percent_of_length", error.maximum * of_length},
            {"mean_percent_of_displacement", error.mean * of_displacement},
            {"rms_percent_of_displacement", error.rms * of_displacement},
            {"max_percent_of_displacement", error.maximum * of_displacement},
            {"hausdorff_mm", state.surface.hausdorff * 1e3},
            {"octree_resolution_mm", state.octree.resolution * 1e3},
            {"octree_estimate_in_truth", state.octree.estimate_in_truth},
            {"octree_truth_in_estimate", state.octree.truth_in_estimate},
            {"measured", state.shapes.camera ? "camera" : "truth surface"}};
  if (state.camera) json["camera_to_estimate"] = json_of(*state.camera);
  if (state.pose_error) {
    const char* const axes[] = {"x", "y", "z"};
    for (int i = 0; i < 3; ++i) {
      json[std::string("pose_") + axes[i] + "_mm"] = (*state.pose_error)[i] * 1e3;
      json[std::string("pose_r") + axes[i] + "_deg"] = (*state.pose_error)[3 + i] / kDegree;
    }
    json["pose_mm"] = state.pose_error->head<3>().norm() * 1e3;
    json["pose_deg"] = state.pose_error->tail<3>().norm() / kDegree;
  }
  return json;
}

nlohmann::json shape_curve(const scores::ShapeScore& shape) {
  Json json{{"time_s", Json::array()}, {"mean_mm", Json::array()}, {"max_mm", Json::array()}};
  const std::size_t step = std::max<std::size_t>(1, shape.samples.size() / kCurvePoints);
  for (std::size_t i = 0; i < shape.samples.size(); i += step) {
    json["time_s"].push_back(shape.samples[i].time);
    json["mean_mm"].push_back(shape.samples[i].mean * 1e3);
    json["max_mm"].push_back(shape.samples[i].maximum * 1e3);
  }
  return json;
}

nlohmann::json control_curves(const scores::FeatureScore& feature, const log::RunLog& log) {
  const auto curve = [&feature](const std::vector<scores::FeatureErrorSample>& samples) {
    Json json{{"time_s", Json::array()}, {"deg", Json::array()}};
    const std::size_t step = std::max<std::size_t>(1, samples.size() / kCurvePoints);
    for (std::size_t i = 0; i < samples.size(); i += step) {
      json["time_s"].push_back(samples[i].time);
      if (feature.is_distance) json["mm"].push_back(samples[i].distance * 1e3);
      if (feature.kind == "curvature") json["per_m"].push_back(samples[i].size);
      json["deg"].push_back(samples[i].angle / kDegree);
    }
    return json;
  };
  Json speed{{"time_s", Json::array()}, {"mm_per_s", Json::array()}};
  const std::int64_t start = log.targets.front().utime;
  const std::size_t step = std::max<std::size_t>(1, log.commands.size() / kCurvePoints);
  for (std::size_t i = 0; i < log.commands.size(); i += step) {
    const twist_command_t& command = log.commands[i];
    if (command.utime < start) continue;
    speed["time_s"].push_back(static_cast<double>(command.utime - start) * 1e-6);
    speed["mm_per_s"].push_back(Eigen::Map<const Eigen::Vector3d>(command.twist).norm() * 1e3);
  }
  return {{"plant", curve(feature.samples)},
          {"estimate", curve(feature.estimated)},
          {"command", std::move(speed)}};
}

}  // namespace palpate::studies
