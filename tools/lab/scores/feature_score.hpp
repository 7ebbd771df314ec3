#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/lab/runs/feature_on_points.hpp"
#include "tools/log/log_reader.hpp"
#include "tools/log/plant_truth.hpp"

namespace palpate::scores {

/// The plant's own feature against its target, at one time.
struct FeatureErrorSample {
  double time = 0;                                     // s since the target was first sent
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m, in O; of a set its centroid
  double distance = 0;                                 // m, to the target; of a set RMS over points
  double angle = 0;  // rad, to the target; 0 but for a pose and an angle
  double size = 0;   // of the error, in the feature's own unit: m, rad of an angle, 1/m
};

/// Into a band and staying there to the end: s since the target; empty where never.
std::optional<double> time_to_stay_within(const std::vector<FeatureErrorSample>& samples,
                                          double distance, double angle);

/// The same of the error's size in the feature's own unit.
std::optional<double> time_to_stay_within(const std::vector<FeatureErrorSample>& samples,
                                          double size);

/// How far the feature went beyond its target along the line from where it started, as a fraction
/// of that line's length; 0 where it never did.
double overshoot(const std::vector<FeatureErrorSample>& samples, const Eigen::Vector3d& target);

struct FeatureScore {
  std::string kind;
  Eigen::Vector3d target = Eigen::Vector3d::Zero();  // m, in O
  std::vector<FeatureErrorSample> samples;
  std::vector<FeatureErrorSample> estimated;  // the same as the daemon saw it, 100 Hz
  double start_distance = 0;                  // m
  double rest_distance = 0;                   // m, mean over the last half second
  double rest_angle = 0;                      // rad
  double rest_largest = 0;                    // m, of a set: of its worst point, at the end
  bool is_distance = true;    // else what is m here is not told, but for an angle's bands
  double start_size = 0;      // of the error, in the feature's own unit
  double rest_size = 0;       // mean over the last half second
  double estimated_size = 0;  // what the daemon took it to be at the end
  double unreachable_size = 0;
  std::optional<double> within_twentieth;  // s, until 5 % of the way are left
  double estimated_distance = 0;           // m, what the daemon took it to be at the end
  double unreachable = 0;                  // m, the part of that which no motion removes
  std::optional<double> within_5mm;        // s, and 1 degree where the feature has an angle
  std::optional<double> within_2mm;        // s, and 0.4 degree
  std::optional<double> within_1mm;        // s, and 0.2 degree
  double overshoot = 0;                    // fraction
  double path = 0;                         // m, length of the way that the feature took
};

/// Scores the last target in the log on the plant. Of a set FEATURE, and so the daemon's own view,
/// holds the first ten points. `steered`: what else than its points defines the feature (axis,
/// harmonics), which no message tells; nullptr: nothing, as of `point`, `pose` (the frame of
/// three), `points` and `distance`. Nothing where the log has no target; throws std::runtime_error
/// where the target names no rest points.
std::optional<FeatureScore> score_feature(const log::RunLog& run,
                                          const runs::FeatureDefinition* steered = nullptr);

}  // namespace palpate::scores
