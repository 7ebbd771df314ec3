#pragma once

#include "core/shape/material_feature.hpp"

namespace palpate::shape {

/// Positions of a set of material points in O, m, up to a sampling of the whole surface: a shape
/// rather than a place. Value, target and error hold x, y, z of one point after the other.
class PointsFeature : public MaterialFeature {
 public:
  static constexpr int kMostPoints = 512;

  struct Options {
    std::vector<Eigen::Vector3d> rest_points;  // in O, m; 1 to kMostPoints
  };

  /// Throws std::invalid_argument where a point is not of the mesh, where two are nearer to one
  /// another than kNearestPair, or where there are none or too many.
  PointsFeature(const mesh::ElementMesh& mesh, const Options& options);

  const char* kind() const noexcept override { return "points"; }
  void evaluate(const Eigen::Matrix3Xd& positions,
                Eigen::Ref<Eigen::VectorXd> value) noexcept override;
};

/// The whole surface, as rest points for a PointsFeature: `count` nodes of the surface spread over
/// it, or all of them where there are fewer. The first is the one that comes first by x, then y,
/// then z; each further one is the node farthest from those before it (farthest-point sampling),
/// the earlier by the same order where several are. So a longer list begins with a shorter one, and
/// the numbering of the mesh does not matter. Corner nodes only.
std::vector<Eigen::Vector3d> surface_points(const mesh::ElementMesh& mesh, int count);

}  // namespace palpate::shape
