#pragma once

#include "core/elasticity/comparison/comparison_model.hpp"
#include "core/elasticity/comparison/lumped_body.hpp"

namespace palpate::elasticity {

struct MassSpringOptions {
  int iterations = 6;       // Newton corrections per step at most, >= 1
  double tolerance = 1e-7;  // N, largest nodal force out of balance at which a step ends early
  int cg_iterations = 200;  // conjugate gradients per correction at most, >= 1
  int halvings = 6;         // of one correction, at most
};

/// Stiffness of the springs along the edges of a tetrahedron as a share of E V / l^2 (V its volume,
/// l the length of the edge): the share at which the network's elasticity tensor is nearest, in the
/// Frobenius norm, to that of an isotropic material of nu = 1/4,
///   s = 6 * 1.2 / sum over pairs of edges of cos^4 of the angle between them.
/// On a regular tetrahedron s = 24/25, which is k = (2 sqrt(2) / 25) l E of Lloyd, Szekely and
/// Harders (IEEE Trans. Vis. Comp. Graph. 13(5), 2007); this extends their criterion to others.
double spring_share(const Eigen::Matrix<double, 3, 4>& corners);

/// Point masses and springs along the edges of linear tetrahedra (the elements, or eight for each
/// quadratic element), with stiffness from E by spring_share(). Central forces in a network near
/// isotropic imply nu = 1/4 whatever the material says (Cauchy's relations), and the match is one
/// of averages: modulus and nu vary with direction and mesh. Inverted elements are not told from
/// good ones. Quarter-volume lumped masses, so that nodal weights differ from the finite elements'.
///
/// Backward Euler with Rayleigh damping (stiffness-proportional along each spring, so that no rigid
/// motion feels it): each step minimises the incremental potential by Newton's method with
/// transverse stiffness of compressed springs left out (positive definite), Jacobi-preconditioned
/// conjugate gradients and halving. Stable at any E and step.
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

  /// Potential energy of the springs in J.
  double elastic_energy() const noexcept;

 private:
  // A spring in the present step: damping makes it stiffer and shifts its length to where it was.
  struct Tension {
    double stiffness, length;
    Eigen::Vector3d direction;  // unit, from b to a
    double across;              // N/m, stiffness against turning, >= 0
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
  double inertia_ = 0;  // 1/s^2, of the present step
  Eigen::Matrix3Xd external_, x_inertial_, x_trial_;
  Eigen::Matrix3Xd dx_, remainder_, conditioned_, search_, product_;  // of conjugate gradients
  std::vector<Eigen::Matrix3d> inverse_diagonal_;
};

}  // namespace palpate::elasticity
