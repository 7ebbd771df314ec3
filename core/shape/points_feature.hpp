#pragma once

#include "core/shape/material_feature.hpp"

namespace palpate::shape {

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

}  // namespace palpate::shape
