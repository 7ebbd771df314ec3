#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "core/math/rigid.hpp"
#include "core/mesh/point_locator.hpp"

namespace palpate::shape {

/// What a row of a feature's error counts in.
enum class Unit { kMetre, kRadian, kPerMetre };

/// A function of the shape that can be steered: its value, its error to a target, and how it
/// follows the nodes. Points are named by rest position, so that a mesh can change beneath it.
/// After construction nothing allocates.
class Feature {
 public:
  virtual ~Feature() = default;
  /// "point", "points", "pose", "distance", "angle", "curvature" or "fourier_contour".
  virtual const char* kind() const noexcept = 0;
  virtual int dimension() const noexcept = 0;    // of error and Jacobian rows
  virtual int value_count() const noexcept = 0;  // of value and target; a pose has 7
  virtual Unit unit(int /*row*/) const noexcept { return Unit::kMetre; }
  virtual const std::vector<Eigen::Vector3d>& rest_points() const noexcept = 0;

  /// Current value from nodal positions, 3 x n in O. A pose: p_O, then w, x, y, z.
  virtual void evaluate(const Eigen::Matrix3Xd& positions,
                        Eigen::Ref<Eigen::VectorXd> value) noexcept = 0;

  /// False where the last evaluate() met points that have come together or lined up such that the
  /// feature or its Jacobian means nothing. Both are finite then too: they are what the last sound
  /// shape had, as far as this one does not give them.
  virtual bool is_defined() const noexcept { return true; }

  /// target minus value as a small motion, dimension() long: m; rad as rotation vector in O.
  virtual void error(const Eigen::Ref<const Eigen::VectorXd>& value,
                     const Eigen::Ref<const Eigen::VectorXd>& target,
                     Eigen::Ref<Eigen::VectorXd> error) const noexcept = 0;

  /// Nodes that the feature depends on.
  virtual const std::vector<int>& support() const noexcept = 0;

  /// d feature / d positions of the support, dimension() x 3 |support|, in the same small-motion
  /// coordinates as error(), at the last evaluate(). Compressed; its pattern never changes.
  virtual const Eigen::SparseMatrix<double>& jacobian() const noexcept = 0;

  /// True where `target` has value_count() finite numbers that make a valid value.
  virtual bool is_valid_target(const double* target, int count) const noexcept = 0;
};

}  // namespace palpate::shape
