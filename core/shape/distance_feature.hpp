#pragma once

#include "core/shape/material_feature.hpp"

namespace palpate::shape {

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
  bool is_defined() const noexcept override { return is_defined_; }
  bool is_valid_target(const double* target, int count) const noexcept override;

 private:
  bool is_defined_ = true;
};

}  // namespace palpate::shape
