#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/shape/feature.hpp"

namespace palpate::runs {

/// Definition of a feature of core/shape, in O.
struct FeatureDefinition {
  std::string kind;
  std::vector<Eigen::Vector3d> rest_points;  // m
  std::optional<Eigen::Vector3d> axis;       // of an angle or a curvature
  // Of a Fourier contour.
  int harmonics = 3;
  bool closed = true;
  std::vector<int> components{0, 1, 2};
};

/// A feature of core/shape evaluated directly on the positions of its own rest points, for a plant
/// whose mesh the feature does not support.
class FeatureOnPoints {
 public:
  /// The components of a `point` are ignored: all three are used. Throws std::invalid_argument if
  /// there is no such feature of these points.
  explicit FeatureOnPoints(const FeatureDefinition& definition);

  int value_count() const { return feature_->value_count(); }
  /// The rest points, 3 x their number.
  const Eigen::Matrix3Xd& rest_points() const { return rest_points_; }
  /// From the current positions of the rest points, 3 x their number.
  Eigen::VectorXd value(const Eigen::Matrix3Xd& points) const;
  /// Target minus value: m, then rad for a pose.
  Eigen::VectorXd error(const Eigen::VectorXd& value, const Eigen::VectorXd& target) const;

  /// Whether its error is a distance: false for an angle or a curvature.
  bool is_distance() const;
  /// Size of an error, or of the part of one that a message holds: m; for a set the root mean
  /// square over its points, for a contour over its length; 0 if it is not a distance.
  double distance(const Eigen::VectorXd& error) const;
  /// rad; 0 if the feature has no angle.
  double angle(const Eigen::VectorXd& error) const;
  /// The same in the feature's own unit: m, rad of an angle, 1/m of a curvature.
  double size(const Eigen::VectorXd& error) const;
  /// m, in O; for a set the centroid, for a contour its mean. A single number is treated as a
  /// position at that distance.
  Eigen::Vector3d place(const Eigen::VectorXd& value) const;

 private:
  bool is(const char* kind) const;

  FeatureDefinition definition_;
  Eigen::Matrix3Xd rest_points_;
  std::unique_ptr<shape::Feature> feature_;
};

}  // namespace palpate::runs
