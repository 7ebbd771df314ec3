#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "core/math/rigid.hpp"
#include "core/mesh/point_locator.hpp"

namespace palpate::shape {

/// Unit of a row of a feature's error.
enum class Unit { kMetre, kRadian, kPerMetre };

/// Controllable function of the shape: its value, its error with respect to a target, and its
/// Jacobian with respect to the nodes. Points are identified by their rest position, independent of
/// the mesh. Nothing allocates after construction.
class Feature {
 public:
  virtual ~Feature() = default;
  /// "point", "points", "pose", "distance", "angle", "curvature" or "fourier_contour".
  virtual const char* kind() const noexcept = 0;
  virtual int dimension() const noexcept = 0;    // number of rows of error and Jacobian
  virtual int value_count() const noexcept = 0;  // length of value and target; 7 for a pose
  virtual Unit unit(int /*row*/) const noexcept { return Unit::kMetre; }
  virtual const std::vector<Eigen::Vector3d>& rest_points() const noexcept = 0;

  /// Current value from node positions, 3 x n in O, m. A pose: p_O, then w, x, y, z.
  virtual void evaluate(const Eigen::Matrix3Xd& positions,
                        Eigen::Ref<Eigen::VectorXd> value) noexcept = 0;

  /// False if the last evaluate() met coincident or collinear points for which the feature or its
  /// Jacobian is undefined. Both are finite nevertheless: undefined parts keep the values of the
  /// last valid shape.
  virtual bool is_defined() const noexcept { return true; }

  /// target minus value as a small motion, length dimension(): m; rad as a rotation vector in O.
  virtual void error(const Eigen::Ref<const Eigen::VectorXd>& value,
                     const Eigen::Ref<const Eigen::VectorXd>& target,
                     Eigen::Ref<Eigen::VectorXd> error) const noexcept = 0;

  /// Nodes on which the feature depends.
  virtual const std::vector<int>& support() const noexcept = 0;

  /// d feature / d positions of the support, dimension() x 3 |support|, in the small-motion
  /// coordinates of error(), at the last evaluate(). Compressed, with a constant pattern.
  virtual const Eigen::SparseMatrix<double>& jacobian() const noexcept = 0;

  /// True if `target` contains value_count() finite numbers that form a valid value.
  virtual bool is_valid_target(const double* target, int count) const noexcept = 0;
};

}  // namespace palpate::shape
