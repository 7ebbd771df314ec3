#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/mesh/point_locator.hpp"
#include "core/shape/feature.hpp"

namespace palpate::shape {

/// Points of the rest shape and the nodes that interpolate them.
class MaterialPoints {
 public:
  /// Throws std::invalid_argument if a point is not finite or lies more than 1 mm outside the mesh.
  MaterialPoints(const mesh::ElementMesh& mesh, std::vector<Eigen::Vector3d> rest_points);

  int count() const noexcept { return static_cast<int>(rest_points_.size()); }
  const std::vector<Eigen::Vector3d>& rest_points() const noexcept { return rest_points_; }

  /// All nodes that interpolate one of the points, sorted.
  const std::vector<int>& support() const noexcept { return support_; }

  /// Current position of `point`, from node positions, 3 x n.
  Eigen::Vector3d position(int point, const Eigen::Matrix3Xd& positions) const noexcept {
    return weights_[point].interpolate(positions);
  }

  /// d point / d position of each node of support(): one factor per node, equal for all axes.
  /// count() x |support|.
  const Eigen::MatrixXd& weights() const noexcept { return support_weights_; }

 private:
  std::vector<Eigen::Vector3d> rest_points_;
  std::vector<mesh::PointWeights> weights_;
  std::vector<int> support_;
  Eigen::MatrixXd support_weights_;
};

/// m: points of a feature nearer to each other than this at rest count as coincident.
inline constexpr double kNearestPair = 1e-3;
/// m: current distance of two points below which their direction is undefined.
inline constexpr double kShortestEdge = 1e-9;
/// Sine of an angle below which its sides count as collinear.
inline constexpr double kFlattest = 1e-3;

/// Base of features that depend on the current positions of a few material points only. Defaults
/// for derived classes: value_count() = dimension(), error = difference, every finite target valid.
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
  bool is_defined() const noexcept override { return is_defined_; }

 protected:
  MaterialFeature(const mesh::ElementMesh& mesh, std::vector<Eigen::Vector3d> rest_points);

  /// For a feature linear in its points: `by_points` is the constant derivative of the error
  /// coordinates with respect to (x, y, z of one point after the other).
  void set_constant(const Eigen::MatrixXd& by_points);
  /// For any other feature: allocates a Jacobian that chain() sets at each evaluate().
  void set_dimension(int dimension);
  void chain(const Eigen::Ref<const Eigen::MatrixXd>& by_points) noexcept;

  int point_count() const noexcept { return points_.count(); }
  Eigen::Vector3d position(int point, const Eigen::Matrix3Xd& positions) const noexcept {
    return points_.position(point, positions);
  }

  bool is_defined_ = true;

 private:
  struct Carrier {
    int point, node;  // of the support
    double weight;
  };

  MaterialPoints points_;
  std::vector<Carrier> carriers_;
  Eigen::SparseMatrix<double> jacobian_;  // after set_dimension() with every entry, including zeros
};

/// `axis` normalised to length 1, if present. Throws std::invalid_argument if it is not a
/// direction.
std::optional<Eigen::Vector3d> unit_axis(const char* kind,
                                         const std::optional<Eigen::Vector3d>& axis);

/// Throws std::invalid_argument with the points of the feature `kind` and what is allowed instead.
[[noreturn]] void reject_points(const char* kind, const std::vector<Eigen::Vector3d>& points,
                                const char* allowed);

/// Throws std::invalid_argument unless there are `least` to `most` points with pairwise distances
/// of at least kNearestPair; `kind` is the feature's name for the message.
const std::vector<Eigen::Vector3d>& checked_points(const char* kind,
                                                   const std::vector<Eigen::Vector3d>& points,
                                                   std::size_t least, std::size_t most);

}  // namespace palpate::shape
