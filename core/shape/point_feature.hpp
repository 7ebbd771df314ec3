#pragma once

#include "core/shape/feature.hpp"
#include "core/shape/material_points.hpp"

namespace palpate::shape {

/// Position of one material point in O, m. Value and target are the whole position (3); error and
/// Jacobian hold only the components that are to be controlled.
class PointFeature : public Feature {
 public:
  struct Options {
    Eigen::Vector3d rest_point = Eigen::Vector3d::Zero();  // in O, m
    std::vector<int> components{0, 1, 2};                  // of 0 = x, 1 = y, 2 = z; each once
  };

  /// Throws std::invalid_argument where the point is not of the mesh or the components are not
  /// a non-empty list of different axes.
  PointFeature(const mesh::ElementMesh& mesh, const Options& options);

  const char* kind() const noexcept override { return "point"; }
  int dimension() const noexcept override { return static_cast<int>(components_.size()); }
  int value_count() const noexcept override { return 3; }
  const std::vector<Eigen::Vector3d>& rest_points() const noexcept override {
    return points_.rest_points();
  }
  void evaluate(const Eigen::Matrix3Xd& positions,
                Eigen::Ref<Eigen::VectorXd> value) noexcept override;
  void error(const Eigen::Ref<const Eigen::VectorXd>& value,
             const Eigen::Ref<const Eigen::VectorXd>& target,
             Eigen::Ref<Eigen::VectorXd> error) const noexcept override;
  const std::vector<int>& support() const noexcept override { return points_.support(); }
  const Eigen::SparseMatrix<double>& jacobian() const noexcept override { return jacobian_; }
  bool is_valid_target(const double* target, int count) const noexcept override;

 private:
  MaterialPoints points_;
  std::vector<int> components_;
  Eigen::SparseMatrix<double> jacobian_;  // constant: a point is a fixed sum of nodes
};

}  // namespace palpate::shape
