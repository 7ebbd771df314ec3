#pragma once

#include "core/shape/material_feature.hpp"

namespace palpate::shape {

/// Position of one material point in O, m. Value and target are the whole position (3); error and
/// Jacobian contain only the controlled components.
class PointFeature : public MaterialFeature {
 public:
  struct Options {
    Eigen::Vector3d rest_point = Eigen::Vector3d::Zero();  // in O, m
    /// Distinct entries of 0 = x, 1 = y, 2 = z.
    std::vector<int> components{0, 1, 2};
  };

  /// Throws std::invalid_argument if the point is not on the mesh or the components are not a
  /// non-empty list of different axes.
  PointFeature(const mesh::ElementMesh& mesh, const Options& options);

  const char* kind() const noexcept override { return "point"; }
  int value_count() const noexcept override { return 3; }
  void evaluate(const Eigen::Matrix3Xd& positions,
                Eigen::Ref<Eigen::VectorXd> value) noexcept override;
  void error(const Eigen::Ref<const Eigen::VectorXd>& value,
             const Eigen::Ref<const Eigen::VectorXd>& target,
             Eigen::Ref<Eigen::VectorXd> error) const noexcept override;

 private:
  std::vector<int> components_;
};

/// Throws std::invalid_argument unless `components` is a non-empty list of distinct values of 0, 1,
/// 2; `kind` is the feature's name for the message.
const std::vector<int>& checked_components(const char* kind, const std::vector<int>& components);

/// Positions of a set of material points in O, m, up to a sampling of the whole surface. Value,
/// target and error contain x, y, z of one point after the other.
class PointsFeature : public MaterialFeature {
 public:
  static constexpr int kMostPoints = 512;

  struct Options {
    std::vector<Eigen::Vector3d> rest_points;  // in O, m; 1 to kMostPoints
  };

  /// Throws std::invalid_argument if a point is not on the mesh, two points are nearer to each
  /// other than kNearestPair, or their number is out of range.
  PointsFeature(const mesh::ElementMesh& mesh, const Options& options);

  const char* kind() const noexcept override { return "points"; }
  void evaluate(const Eigen::Matrix3Xd& positions,
                Eigen::Ref<Eigen::VectorXd> value) noexcept override;
};

/// Sample of the whole surface, as rest points for a PointsFeature: `count` corner nodes of the
/// surface, or all if there are fewer, by farthest-point sampling. The first is the smallest by x,
/// then y, then z; each further one is the node farthest from the previous ones, ties resolved by
/// the same order. A longer list therefore begins with a shorter one, and the numbering of the mesh
/// has no influence.
std::vector<Eigen::Vector3d> surface_points(const mesh::ElementMesh& mesh, int count);

/// Same, of the part of the surface that these triangles (corner nodes) form.
std::vector<Eigen::Vector3d> surface_points(const mesh::ElementMesh& mesh,
                                            const Eigen::Matrix3Xi& triangles, int count);

/// Distance |p2 - p1| of two material points, m. One number; targets are at least 0.
class DistanceFeature : public MaterialFeature {
 public:
  struct Options {
    std::vector<Eigen::Vector3d> rest_points;  // p1, p2 in O, m
  };

  /// Throws std::invalid_argument unless there are two points on the mesh, kNearestPair apart.
  DistanceFeature(const mesh::ElementMesh& mesh, const Options& options);

  const char* kind() const noexcept override { return "distance"; }
  /// If the points coincide, the Jacobian keeps their last direction.
  void evaluate(const Eigen::Matrix3Xd& positions,
                Eigen::Ref<Eigen::VectorXd> value) noexcept override;
  bool is_valid_target(const double* target, int count) const noexcept override;
};

}  // namespace palpate::shape
