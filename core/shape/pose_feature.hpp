#pragma once

#include <array>

#include "core/shape/material_feature.hpp"

namespace palpate::shape {

/// Frame C of three material points p1, p2, p3: origin at their centroid, x from p1 towards p2, z
/// along the normal (p2 - p1) x (p3 - p1), y = z x x. Value and target: p_OC (m), then the
/// quaternion of R_OC as w, x, y, z. Error: p_target - p, then the rotation vector of
/// R_target R^T, in O; its angle is at most pi.
class PoseFeature : public MaterialFeature {
 public:
  struct Options {
    std::array<Eigen::Vector3d, 3> rest_points{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
                                               Eigen::Vector3d::Zero()};  // in O, m
  };

  /// Throws std::invalid_argument if a point is not on the mesh or the three are collinear.
  PoseFeature(const mesh::ElementMesh& mesh, const Options& options);

  const char* kind() const noexcept override { return "pose"; }
  int value_count() const noexcept override { return 7; }
  Unit unit(int row) const noexcept override { return row < 3 ? Unit::kMetre : Unit::kRadian; }
  /// Keeps the last orientation while the points are collinear.
  void evaluate(const Eigen::Matrix3Xd& positions,
                Eigen::Ref<Eigen::VectorXd> value) noexcept override;
  void error(const Eigen::Ref<const Eigen::VectorXd>& value,
             const Eigen::Ref<const Eigen::VectorXd>& target,
             Eigen::Ref<Eigen::VectorXd> error) const noexcept override;
  bool is_valid_target(const double* target, int count) const noexcept override;

 private:
  void turn_with(const Eigen::Vector3d& a, const Eigen::Vector3d& b) noexcept;

  Eigen::Matrix3d R_OC_ = Eigen::Matrix3d::Identity();
  Eigen::Matrix<double, 6, 9> by_points_;
};

}  // namespace palpate::shape
