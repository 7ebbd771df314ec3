#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/math/rigid.hpp"
#include "tools/lab/scores/cloud_distance.hpp"
#include "tools/lab/scores/octree_score.hpp"
#include "tools/lab/scores/report.hpp"
#include "tools/lab/studies/study_plan.hpp"
#include "tools/log/log_reader.hpp"

namespace palpate::studies {

/// Shapes at one instant, in O, m.
struct StateShapes {
  Eigen::Matrix3Xd measured;  // cloud: of the camera, or sampled on the plant's surface
  bool camera = false;
  draw::TriangleMesh truth;
  draw::TriangleMesh estimate;
};

/// One state of the object, such as a held pose of the hand.
struct StateScore {
  std::string name;
  double time = 0;                  // s since the first estimate
  double displacement = 0;          // m, largest true displacement from rest
  scores::ErrorSummary error;       // of the nodes, over the last half second
  scores::SurfaceDistance surface;  // truth is the first
  scores::OctreeAgreement octree;
  std::optional<scores::DistanceSummary> camera;  // distance of the measured points to the estimate
  /// Estimate minus plant: m, in O, then rotation vector, rad; mean over the last half second.
  std::optional<math::Vector6d> pose_error;
  StateShapes shapes;
};

/// Scores the states of a job: those that it names, or the held poses, or (kind control) the end.
/// X_WO: pose of the object as palpated is configured; X_OP: pose of the plant's O (P) in that O.
/// Throws std::runtime_error if the log ends before a state.
std::vector<StateScore> score_states(const StudyJob& job, const log::RunLog& log,
                                     const scores::ShapeScore& shape, const math::Pose& X_WO,
                                     const math::Pose& X_OP = math::Pose::Identity());

nlohmann::json to_json(const StateScore& state, double length);

/// Mean and largest node error over time, decimated.
nlohmann::json shape_curve(const scores::ShapeScore& shape);

/// Error over time of the plant's feature and the daemon's, and the commanded speed, decimated.
nlohmann::json control_curves(const scores::FeatureScore& feature, const log::RunLog& log);

}  // namespace palpate::studies
