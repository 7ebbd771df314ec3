#pragma once

#include <array>
#include <optional>

#include "core/shape/material_feature.hpp"

namespace palpate::shape {

/// Curvature of a line through three or five ordered material points, 1/m. Three points: curvature
/// of their circumscribed circle (Menger),
///   kappa = 2 m . (a x b) / (|a| |b| |a + b|),   a = p2 - p1,   b = p3 - p2;
/// five points: mean over the three triples of neighbours. Points on one circle give 1 / radius for
/// any spacing.
///
/// Without an axis m is the line's own normal (a x b) / |a x b|, so that kappa >= 0, and a straight
/// line cannot be controlled. With an axis, fixed in O, m is the axis: kappa is positive for a left
/// turn seen from the tip of the axis, and smooth through the straight line. The error is target -
/// value.
class CurvatureFeature : public MaterialFeature {
 public:
  struct Options {
    std::vector<Eigen::Vector3d> rest_points;  // 3 or 5 along the line, in O, m
    std::optional<Eigen::Vector3d> axis;       // in O, any length but 0
  };

  /// Throws std::invalid_argument unless there are three or five points on the mesh, at least
  /// kNearestPair apart, and, without an axis, no three neighbours are collinear.
  CurvatureFeature(const mesh::ElementMesh& mesh, const Options& options);

  const char* kind() const noexcept override { return "curvature"; }
  Unit unit(int /*row*/) const noexcept override { return Unit::kPerMetre; }
  /// If two points coincide, the triple's contribution to value and Jacobian keeps its last value;
  /// if a triple becomes collinear, without an axis, its last normal is used.
  void evaluate(const Eigen::Matrix3Xd& positions,
                Eigen::Ref<Eigen::VectorXd> value) noexcept override;
  bool is_valid_target(const double* target, int count) const noexcept override;

 private:
  struct Triple {
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    double curvature = 0;
    Eigen::RowVector3d by_a = Eigen::RowVector3d::Zero();
    Eigen::RowVector3d by_b = Eigen::RowVector3d::Zero();
  };
  bool measure(const Eigen::Vector3d& a, const Eigen::Vector3d& b, Triple& triple) const noexcept;

  std::optional<Eigen::Vector3d> axis_;
  std::array<Triple, 3> triples_;
};

}  // namespace palpate::shape
