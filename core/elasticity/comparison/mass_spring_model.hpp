#pragma once

#include "core/elasticity/comparison/comparison_model.hpp"
#include "core/elasticity/comparison/lumped_body.hpp"

namespace palpate::elasticity {

struct MassSpringOptions {
  int iterations = 6;       // maximum number of Newton corrections per step, >= 1
  double tolerance = 1e-7;  // N, largest unbalanced nodal force at which a step ends early
  int cg_iterations = 200;  // maximum number of conjugate gradient iterations per correction, >= 1
  int halvings = 6;         // maximum number of halvings of one correction
};

/// Stiffness of the springs along the edges of a tetrahedron relative to E V / l^2 (V its volume, l
/// the length of the edge), such that the network's elasticity tensor is nearest, in the Frobenius
/// norm, to that of an isotropic material with nu = 1/4, s = 6 * 1.2 / sum over pairs of edges of
/// cos^4 of the angle between them. On a regular tetrahedron s = 24/25, which is k = (2 sqrt(2) /
/// 25) l E of Lloyd, Szekely and Harders (IEEE Trans. Vis. Comp. Graph. 13(5), 2007); this extends
/// their criterion to other shapes.
double spring_share(const Eigen::Matrix<double, 3, 4>& corners);

/// Point masses and springs along the edges of linear tetrahedra (the elements, or eight per
/// quadratic element), with stiffness from Young's modulus by spring_share(). Central forces in a
/// nearly isotropic network imply nu = 1/4 whatever the material (Cauchy's relations), and the
/// match is an average: modulus and nu vary with direction and mesh. Inverted elements are not
/// distinguished from valid ones. Masses are lumped by quarter volumes, so that nodal weights
/// differ from those of the finite elements.
///
/// Backward Euler with Rayleigh damping (stiffness-proportional along each spring, so that rigid
/// motions are undamped): each step minimises the incremental potential by Newton's method without
/// the transverse stiffness of compressed springs (positive definite), Jacobi-preconditioned
/// conjugate gradients and step halving. Stable for any modulus and step size.
class MassSpringModel final : public ComparisonModel {
 public:
  /// Throws std::invalid_argument for an invalid body, element or option.
  explicit MassSpringModel(Body body, const MassSpringOptions& options = {});

  struct Spring {
    int a, b;          // nodes, a < b
    double length;     // m, at rest
    double stiffness;  // N/m
  };
  const std::vector<Spring>& springs() const noexcept { return springs_; }
  const Eigen::VectorXd& masses() const noexcept { return masses_; }  // kg, by node

  /// Potential energy of the springs, J.
  double elastic_energy() const noexcept;

 private:
  // Spring in the present step: damping increases its stiffness and shifts its rest length.
  struct Tension {
    double stiffness, length;
    Eigen::Vector3d direction;  // unit vector from b to a
    double across;              // N/m, transverse stiffness, >= 0
  };

  StepReport advance(double dt) noexcept override;
  void begin_step(double dt) noexcept;
  double evaluate() noexcept;
  double residual() const noexcept;
  void precondition() noexcept;
  void multiply(const Eigen::Matrix3Xd& u, Eigen::Matrix3Xd& y) const noexcept;
  void solve() noexcept;

  MassSpringOptions options_;
  std::vector<Spring> springs_;
  Eigen::VectorXd masses_;
  std::vector<Tension> tensions_;
  double inertia_ = 0;  // 1/s^2, inertia term of the present step
  Eigen::Matrix3Xd external_, x_inertial_, x_trial_;
  /// Workspace of the conjugate gradients.
  Eigen::Matrix3Xd dx_, remainder_, conditioned_, search_, product_;
  std::vector<Eigen::Matrix3d> inverse_diagonal_;
};

}  // namespace palpate::elasticity
