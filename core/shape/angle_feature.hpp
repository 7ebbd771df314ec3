#pragma once

#include <optional>

#include "core/shape/material_feature.hpp"

namespace palpate::shape {

/// Angle between two directions in the material, rad. Three points p1, p2, p3: at p2, from a = p1 -
/// p2 to b = p3 - p2. Four points: from a = p2 - p1 to b = p4 - p3.
///
/// Without an axis: range 0 to pi, atan2(|a x b|, a . b). At pi (a straight line) it cannot be
/// controlled, because every bending reduces it. With an axis n, fixed in O: angle of a and b
/// projected along n, right-handed about n, atan2(n . (a x b), a . b - (n . a)(n . b)) in (-pi,
/// pi], smooth through the straight line; error = target - value is then wrapped to [-pi, pi).
/// Targets lie within pi of 0; without an axis from 0 to pi.
class AngleFeature : public MaterialFeature {
 public:
  struct Options {
    std::vector<Eigen::Vector3d> rest_points;  // 3 or 4, in O, m
    std::optional<Eigen::Vector3d> axis;       // in O, any length but 0
  };

  /// Throws std::invalid_argument unless there are three or four points on the mesh whose
  /// directions are not collinear (without an axis) or not parallel to the axis (with one).
  AngleFeature(const mesh::ElementMesh& mesh, const Options& options);

  const char* kind() const noexcept override { return "angle"; }
  Unit unit(int /*row*/) const noexcept override { return Unit::kRadian; }
  /// Where the angle is undefined, value and Jacobian keep their last values.
  void evaluate(const Eigen::Matrix3Xd& positions,
                Eigen::Ref<Eigen::VectorXd> value) noexcept override;
  void error(const Eigen::Ref<const Eigen::VectorXd>& value,
             const Eigen::Ref<const Eigen::VectorXd>& target,
             Eigen::Ref<Eigen::VectorXd> error) const noexcept override;
  bool is_valid_target(const double* target, int count) const noexcept override;

 private:
  bool measure(const Eigen::Vector3d& a, const Eigen::Vector3d& b) noexcept;

  std::optional<Eigen::Vector3d> axis_;
  double angle_ = 0;
  Eigen::RowVector3d by_a_, by_b_;
};

}  // namespace palpate::shape
