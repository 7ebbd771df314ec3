#pragma once

#include <array>
#include <vector>

#include "core/elasticity/element.hpp"
#include "core/factor/block_matrix.hpp"
#include "core/factor/supernodal_factor.hpp"
#include "core/solid/solid_material.hpp"

namespace palpate::solid {

/// Largest Euclidean norm of a column.
inline double largest_norm(const Eigen::Matrix3Xd& field) {
  return field.colwise().norm().maxCoeff();
}

/// Ten-node tetrahedra of one hyperelastic solid (SolidCoefficients), for fitting. Constant after
/// construction.
class SolidElements {
 public:
  /// Throws std::invalid_argument unless `mesh` is quadratic with elements of positive volume.
  explicit SolidElements(const mesh::ElementMesh& mesh);

  const mesh::ElementMesh& mesh() const { return mesh_; }

  /// Energy, J, at positions x, and `forces` = dEnergy/dx, N, both 3 x n. Returns infinity, with
  /// undefined forces, if a point is inverted.
  double forces(const Eigen::Matrix3Xd& x, const SolidCoefficients& c,
                Eigen::Matrix3Xd& forces) const;

  /// Adds `factor` times the second derivative of the energy. No point may be inverted at x.
  void add_tangent(const Eigen::Matrix3Xd& x, const SolidCoefficients& c, double factor,
                   factor::BlockMatrix& tangent) const;

 private:
  using Element = elasticity::Tetrahedron<10>;
  using Nodes = Element::Gradients;
  struct Shape {
    std::array<Nodes, Element::kPoints> gradients;  // 1/m
    double weight = 0;                              // m^3, volume of a point
  };

  Nodes gather(int element, const Eigen::Matrix3Xd& x) const;

  mesh::ElementMesh mesh_;
  std::vector<Shape> shapes_;
};

struct SolidOptions {
  int iterations = 60;      // maximum number of Newton steps per load step
  double tolerance = 1e-9;  // largest unbalanced nodal force relative to the largest nodal force
  int load_steps = 32;      // maximum number; the load is divided only if Newton's method fails
};

/// Derivative of the equations of a solid with respect to a parameter.
struct SolidSlope {
  SolidCoefficients coefficients;
  Eigen::Matrix3Xd load;        // N, 3 x n; empty: none
  Eigen::Matrix3Xd start;       // m, 3 x n, of the initial positions of a motion; empty: none
  double density = 0;           // kg/m^3, of inertia only: the weight is part of `load`
  double mass_factor = 0;       // 1/s, of the damping
  double stiffness_factor = 0;  // s, of the damping
};

/// Discretised solid with some fixed nodes. Constant after construction, therefore shareable
/// between threads; construction is not thread-safe.
class SolidBody {
 public:
  /// Throws std::invalid_argument as SolidElements and BlockPattern do, and if no node is fixed.
  SolidBody(const mesh::ElementMesh& mesh, const std::vector<int>& fixed_nodes);
  SolidBody(const SolidBody&) = delete;
  SolidBody& operator=(const SolidBody&) = delete;

  const SolidElements& elements() const { return elements_; }
  const mesh::ElementMesh& mesh() const { return elements_.mesh(); }
  const factor::BlockPattern& pattern() const { return pattern_; }
  const factor::Supernodes& supernodes() const { return supernodes_; }
  double extent() const { return extent_; }  // m, diagonal of the bounding box

  /// Integral of each node's shape function, m^3: multiplied by density and g, its weight.
  const Eigen::VectorXd& nodal_volume() const { return nodal_volume_; }

  /// Consistent mass for unit density (m^3), one number per stored block of pattern().
  const Eigen::VectorXd& volume_blocks() const { return volume_blocks_; }

 private:
  SolidElements elements_;
  factor::BlockPattern pattern_;
  factor::Supernodes supernodes_;
  Eigen::VectorXd nodal_volume_, volume_blocks_;
  double extent_;
};

/// Static equilibrium of a hyperelastic solid, offline: allocates, and factors in every Newton
/// step. Not thread-safe.
class SolidSolver {
 public:
  /// `body` must outlive the solver.
  explicit SolidSolver(const SolidBody& body) : body_(body), factor_(body.supernodes()) {}
  SolidSolver(const SolidSolver&) = delete;
  SolidSolver& operator=(const SolidSolver&) = delete;

  const SolidBody& body() const { return body_; }

  /// Positions at which the forces of the solid balance `loads` (N, 3 x n), starting at x, in which
  /// the fixed nodes keep their positions. False if Newton's method finds none; x is then
  /// undefined. On success the factor is that of the tangent at x.
  bool solve(const SolidCoefficients& c, const Eigen::Matrix3Xd& loads, Eigen::Matrix3Xd& x,
             const SolidOptions& options = {});

  /// Derivative of the positions found by the last solve() with these constants.
  Eigen::Matrix3Xd sensitivity(const Eigen::Matrix3Xd& x, const SolidSlope& slope);

  /// Factors a matrix over pattern() and uses it from now on; false unless it is positive definite.
  bool factorise(const factor::BlockMatrix& matrix);

  /// Solution for a nodal right-hand side with the present factor; zero at fixed nodes.
  Eigen::Matrix3Xd apply_inverse(const Eigen::Matrix3Xd& rhs);

  /// Rounding error of nodal forces with the present factor, N.
  double rounding() const;

  /// Sets the columns of fixed nodes to zero.
  void clear_fixed(Eigen::Matrix3Xd& field) const;

  /// Tangent at x over the free nodes.
  factor::BlockMatrix tangent(const Eigen::Matrix3Xd& x, const SolidCoefficients& c) const;

 private:
  bool newton(const SolidCoefficients& c, const Eigen::Matrix3Xd& loads, Eigen::Matrix3Xd& x,
              const SolidOptions& options);

  const SolidBody& body_;
  factor::SupernodalFactor factor_;
};

}  // namespace palpate::solid
