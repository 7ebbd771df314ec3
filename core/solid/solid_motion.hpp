#pragma once

#include "core/elasticity/body.hpp"
#include "core/solid/solid_solver.hpp"

namespace palpate::solid {

/// Dynamic problem: the solid with its constants, constant loads, and point masses attached to
/// nodes.
struct SolidMotionProblem {
  SolidCoefficients coefficients;
  Eigen::Matrix3Xd loads;             // N, 3 x n
  double density = 0;                 // kg/m^3
  Eigen::VectorXd nodal_mass;         // kg, point masses attached to nodes; empty: none
  elasticity::Damping damping{0, 0};  // Rayleigh damping
};

/// Motion of a hyperelastic solid, with forward derivatives by parameter. Trapezoidal rule,
///   M (v' - v)/h + a M (v + v')/2 + (f(x) + f(x'))/2 + b (f(x') - f(x))/h = loads,
///   x' = x + h (v + v')/2,
/// of second order and without numerical damping. The term with b is the mean of b df/dt = b K v
/// over the step: Rayleigh damping with the current tangent, solved exactly.
class SolidMotion {
 public:
  /// Starts at rest at x; derivatives are computed for the parameters in `slopes`. `solver` must
  /// outlive this object, which uses it exclusively.
  SolidMotion(SolidSolver& solver, SolidMotionProblem problem, const Eigen::Matrix3Xd& x,
              double step, std::vector<SolidSlope> slopes);

  /// Advances by one step; false if Newton's method finds no solution.
  bool advance();

  const Eigen::Matrix3Xd& positions() const { return x_; }
  const Eigen::Matrix3Xd& velocities() const { return v_; }
  double energy() const;  // J, strain and kinetic energy minus the work of the loads
  /// Derivatives of positions by parameter.
  const Eigen::Matrix3Xd& position_slope(int parameter) const { return dx_[parameter]; }

 private:
  /// Unbalanced forces at the end of a step to x, whose forces are given.
  Eigen::Matrix3Xd imbalance(const Eigen::Matrix3Xd& x, const Eigen::Matrix3Xd& forces) const;
  bool factorise(const factor::BlockMatrix& stiffness);
  bool correct(Eigen::Matrix3Xd& x, Eigen::Matrix3Xd& forces);
  void carry_slopes(const Eigen::Matrix3Xd& x, const Eigen::Matrix3Xd& forces);
  static Eigen::Matrix3Xd times(const factor::BlockMatrix& matrix, const Eigen::Matrix3Xd& u);

  SolidSolver& solver_;
  SolidMotionProblem problem_;
  double h_;
  double now_, before_;  // weights of the forces at the end and the beginning of a step
  std::vector<SolidSlope> slopes_;
  /// m^3; kg; N/m at x_, if derivatives are requested
  factor::BlockMatrix volume_, mass_, stiffness_;
  Eigen::Matrix3Xd x_, v_, forces_;
  std::vector<Eigen::Matrix3Xd> dx_, dv_;
};

}  // namespace palpate::solid
