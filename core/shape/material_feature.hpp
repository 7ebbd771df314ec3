#pragma once

#include <optional>

#include "core/shape/feature.hpp"
#include "core/shape/material_points.hpp"

namespace palpate::shape {

/// Points of a feature that are nearer to one another than this at rest count as one, m.
inline constexpr double kNearestPair = 1e-3;
/// Present distance of two points below which they have no direction, m.
inline constexpr double kShortestEdge = 1e-9;
/// Sine of an angle below which its sides are on one line.
inline constexpr double kFlattest = 1e-3;

/// A feature of the present places of a few material points: what follows from that alone. One that
/// says no more has value_count() = dimension(), the plain difference for an error, and takes any
/// finite target.
class MaterialFeature : public Feature {
 public:
  int dimension() const noexcept override { return static_cast<int>(jacobian_.rows()); }
  int value_count() const noexcept override { return dimension(); }
  const std::vector<Eigen::Vector3d>& rest_points() const noexcept override {
    return points_.rest_points();
  }
  void error(const Eigen::Ref<const Eigen::VectorXd>& value,
             const Eigen::Ref<const Eigen::VectorXd>& target,
             Eigen::Ref<Eigen::VectorXd> error) const noexcept override;
  const std::vector<int>& support() const noexcept override { return points_.support(); }
  const Eigen::SparseMatrix<double>& jacobian() const noexcept override { return jacobian_; }
  bool is_valid_target(const double* target, int count) const noexcept override;

 protected:
  MaterialFeature(const mesh::ElementMesh& mesh, std::vector<Eigen::Vector3d> rest_points);

  /// Of a feature linear in its points: `by_points` is d error coordinates / d (x, y, z of one
  /// point after the other), for good.
  void set_constant(const Eigen::MatrixXd& by_points);
  /// Of any other: room for a Jacobian that chain() then sets at each evaluate().
  void set_dimension(int dimension);
  void chain(const Eigen::Ref<const Eigen::MatrixXd>& by_points) noexcept;

  int point_count() const noexcept { return points_.count(); }
  Eigen::Vector3d position(int point, const Eigen::Matrix3Xd& positions) const noexcept {
    return points_.position(point, positions);
  }

 private:
  struct Carrier {
    int point, node;  // of the support
    double weight;
  };

  MaterialPoints points_;
  std::vector<Carrier> carriers_;
  Eigen::SparseMatrix<double> jacobian_;  // after set_dimension() with every entry, zeros too
};

/// `axis` at length 1, if there is one. Throws std::invalid_argument where it is not a direction.
std::optional<Eigen::Vector3d> unit_axis(const char* kind,
                                         const std::optional<Eigen::Vector3d>& axis);

/// Throws std::invalid_argument unless there are `least` to `most` points, each pair of them
/// kNearestPair apart; `kind` is the feature's name for the text.
const std::vector<Eigen::Vector3d>& checked_points(const char* kind,
                                                   const std::vector<Eigen::Vector3d>& points,
                                                   std::size_t least, std::size_t most);

}  // namespace palpate::shape
