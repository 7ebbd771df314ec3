#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/shape/feature.hpp"

namespace palpate::evaluate {

/// A feature of core/shape taken directly from the positions of its own rest points, for a plant
/// whose mesh the feature does not understand.
class FeatureOnPoints {
 public:
  /// kind: `point` with one rest point, `pose` with three, `points` with 1 to 64, `distance` with
  /// two; points in O, m. Throws std::invalid_argument for anything else: of angles, curvatures and
  /// contours a target does not say all that defines them.
  FeatureOnPoints(const std::string& kind, const std::vector<Eigen::Vector3d>& rest_points);

  int value_count() const { return feature_->value_count(); }
  /// The rest points, 3 x their number.
  const Eigen::Matrix3Xd& rest_points() const { return rest_points_; }
  /// From the present positions of the rest points, 3 x their number.
  Eigen::VectorXd value(const Eigen::Matrix3Xd& points) const;
  /// Target minus value: m, then rad for a pose.
  Eigen::VectorXd error(const Eigen::VectorXd& value, const Eigen::VectorXd& target) const;

  /// How far an error, or the part of one that a message holds, is from none: m, of a set the root
  /// mean square over its points.
  double distance(const Eigen::VectorXd& error) const;
  /// rad; 0 where the feature has no orientation.
  double angle(const Eigen::VectorXd& error) const;
  /// m, in O; of a set the centroid. A distance counts as a place that far out.
  Eigen::Vector3d place(const Eigen::VectorXd& value) const;

 private:
  bool is_set() const;

  Eigen::Matrix3Xd rest_points_;
  std::unique_ptr<shape::Feature> feature_;
};

}  // namespace palpate::evaluate
