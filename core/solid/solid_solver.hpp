#pragma once

#include <vector>

#include "core/factor/supernodal_factor.hpp"
#include "core/solid/solid_elements.hpp"

namespace palpate::solid {

struct SolidOptions {
  int iterations = 60;      // Newton steps per load step at most
  double tolerance = 1e-9;  // largest nodal force out of balance over the largest nodal force
  int load_steps = 32;      // at most; the load is split only where Newton fails
};

/// How the equations of a solid depend on a parameter, per unit of it.
struct SolidSlope {
  SolidCoefficients coefficients;
  Eigen::Matrix3Xd load;        // N, 3 x n; empty: none
  Eigen::Matrix3Xd start;       // m, 3 x n, of the positions that a motion starts from; empty: none
  double density = 0;           // kg/m^3, of inertia only: the weight is part of `load`
  double mass_factor = 0;       // 1/s, of damping
  double stiffness_factor = 0;  // s, of damping
};

/// A solid with some nodes fixed, as its solvers see it. Constant after construction: threads may
/// share it. Construction itself is for one thread at a time.
class SolidBody {
 public:
  /// Throws std::invalid_argument as SolidElements and BlockPattern do, and where nothing is fixed.
  SolidBody(const mesh::ElementMesh& mesh, const std::vector<int>& fixed_nodes);
  SolidBody(const SolidBody&) = delete;
  SolidBody& operator=(const SolidBody&) = delete;

  const SolidElements& elements() const { return elements_; }
  const mesh::ElementMesh& mesh() const { return elements_.mesh(); }
  const factor::BlockPattern& pattern() const { return pattern_; }
  const factor::Supernodes& supernodes() const { return supernodes_; }
  double extent() const { return extent_; }  // m, of the box around it

  /// Integral of each node's shape function, m^3: times density and g its weight.
  const Eigen::VectorXd& nodal_volume() const { return nodal_volume_; }

  /// Consistent mass of unit density (m^3), one number for each stored block of pattern().
  const Eigen::VectorXd& volume_blocks() const { return volume_blocks_; }

 private:
  SolidElements elements_;
  factor::BlockPattern pattern_;
  factor::Supernodes supernodes_;
  Eigen::VectorXd nodal_volume_, volume_blocks_;
  double extent_;
};

/// Equilibrium of a hyperelastic solid, off line: allocates, and factors in every Newton step. Not
/// for several threads at once.
class SolidSolver {
 public:
  /// `body` outlives the solver.
  explicit SolidSolver(const SolidBody& body) : body_(body), factor_(body.supernodes()) {}
  SolidSolver(const SolidSolver&) = delete;
  SolidSolver& operator=(const SolidSolver&) = delete;

  const SolidBody& body() const { return body_; }

  /// Positions where the forces of the solid balance `loads` (N, 3 x n), from x on, where the fixed
  /// nodes are and stay. False where Newton finds none; x is then of no use. In the end the factor
  /// is that of the tangent at x.
  bool solve(const SolidCoefficients& c, const Eigen::Matrix3Xd& loads, Eigen::Matrix3Xd& x,
             const SolidOptions& options = {});

  /// Derivative of the positions that solve() found last with these constants.
  Eigen::Matrix3Xd sensitivity(const Eigen::Matrix3Xd& x, const SolidSlope& slope);

  /// Takes a matrix over pattern() as the present one; false unless positive definite.
  bool factorise(const factor::BlockMatrix& matrix);

  /// Solution for a nodal right-hand side with the present factor; fixed nodes get zero.
  Eigen::Matrix3Xd apply_inverse(const Eigen::Matrix3Xd& rhs);

  /// What rounding leaves of nodal forces under the present factor, N.
  double rounding() const;

  /// Sets the rows of fixed nodes to zero.
  void clear_fixed(Eigen::Matrix3Xd& field) const;

  /// The tangent at x over the free nodes.
  factor::BlockMatrix tangent(const Eigen::Matrix3Xd& x, const SolidCoefficients& c) const;

 private:
  bool newton(const SolidCoefficients& c, const Eigen::Matrix3Xd& loads, Eigen::Matrix3Xd& x,
              const SolidOptions& options);

  const SolidBody& body_;
  factor::SupernodalFactor factor_;
};

}  // namespace palpate::solid
