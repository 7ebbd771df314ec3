#pragma once

#include "core/shape/feature.hpp"
#include "core/shape/material_points.hpp"

namespace palpate::shape {

/// Positions of a set of material points in O, m, up to a sampling of the whole surface: a shape
/// rather than a place. Value, target and error hold x, y, z of one point after the other.
class PointsFeature : public Feature {
 public:
  static constexpr int kMostPoints = 64;        // what one target message holds
  static constexpr double kNearestPair = 1e-3;  // m

  struct Options {
    std::vector<Eigen::Vector3d> rest_points;  // in O, m; 1 to kMostPoints
  };

  /// Throws std::invalid_argument where a point is not of the mesh, where two are nearer to one
  /// another than kNearestPair, or where there are none or too many.
  PointsFeature(const mesh::ElementMesh& mesh, const Options& options);

  const char* kind() const noexcept override { return "points"; }
  int dimension() const noexcept override { return 3 * points_.count(); }
  int value_count() const noexcept override { return 3 * points_.count(); }
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
  Eigen::SparseMatrix<double> jacobian_;  // constant: each point is a fixed sum of nodes
};

}  // namespace palpate::shape
