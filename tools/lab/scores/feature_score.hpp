#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/math/rigid.hpp"
#include "tools/lab/runs/feature_on_points.hpp"
#include "tools/log/log_reader.hpp"
#include "tools/log/plant_truth.hpp"

namespace palpate::scores {

/// The plant's own feature relative to its target, at one time.
struct FeatureErrorSample {
  double time = 0;                                     // s since the target was first sent
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m, in O; centroid of a set
  double distance = 0;  // m, to the target; RMS over the points of a set
  double angle = 0;     // rad, to the target; 0 but for a pose and an angle
  double size = 0;      // of the error, in the feature's own unit: m, rad of an angle, 1/m
};

/// Settling time: s since the target until the error enters a band and stays there to the end;
/// empty if never.
std::optional<double> time_to_stay_within(const std::vector<FeatureErrorSample>& samples,
                                          double distance, double angle);

/// The same for the error norm in the feature's own unit.
std::optional<double> time_to_stay_within(const std::vector<FeatureErrorSample>& samples,
                                          double size);

/// Overshoot along the line from start to target, as a fraction of that line's length; 0 if there
/// is none.
double overshoot(const std::vector<FeatureErrorSample>& samples, const Eigen::Vector3d& target);

struct FeatureScore {
  std::string kind;
  Eigen::Vector3d target = Eigen::Vector3d::Zero();  // m, in O
  std::vector<FeatureErrorSample> samples;
  std::vector<FeatureErrorSample> estimated;  // as estimated by the daemon, 100 Hz
  double start_distance = 0;                  // m
  double rest_distance = 0;                   // m, mean over the last half second
  double rest_angle = 0;                      // rad
  double rest_largest = 0;                    // m, of the worst point of a set, at the end
  bool is_distance = true;    // otherwise quantities in m are omitted, except an angle's bands
  double start_size = 0;      // of the error, in the feature's own unit
  double rest_size = 0;       // mean over the last half second
  double estimated_size = 0;  // the daemon's estimate at the end
  double unreachable_size = 0;
  std::optional<double> within_twentieth;  // s, until 5 % of the distance remain
  double estimated_distance = 0;           // m, the daemon's estimate at the end
  double unreachable = 0;                  // m, the part of it that no motion of the hand removes
  std::optional<double> within_5mm;        // s, and 1 degree if the feature has an angle
  std::optional<double> within_2mm;        // s, and 0.4 degree
  std::optional<double> within_1mm;        // s, and 0.2 degree
  double overshoot = 0;                    // fraction
  double path = 0;                         // m, path length of the feature
};

/// Scores the last target in the log on the plant. For a set, FEATURE, and therefore the daemon's
/// estimate, holds the first ten points. `steered`: definition of the feature beyond its points
/// (axis, harmonics), which no message carries; nullptr: none, as for `point`, `pose` (the frame of
/// three), `points` and `distance`. X_OP: pose of the plant's O (P) in palpated's O, in which the
/// target is. Empty if the log has no target; throws std::runtime_error if
/// the target names no rest points.
std::optional<FeatureScore> score_feature(const log::RunLog& run,
                                          const runs::FeatureDefinition* steered = nullptr,
                                          const math::Pose& X_OP = math::Pose::Identity());

}  // namespace palpate::scores
