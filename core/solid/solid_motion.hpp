#pragma once

#include "core/elasticity/body.hpp"
#include "core/solid/solid_solver.hpp"

namespace palpate::solid {

/// What moves: the solid with its constants, loads that stay, point masses that ride on nodes.
struct SolidMotionProblem {
  SolidCoefficients coefficients;
  Eigen::Matrix3Xd loads;             // N, 3 x n
  double density = 0;                 // kg/m^3
  Eigen::VectorXd nodal_mass;         // kg, of points fixed to nodes; empty: none
  elasticity::Damping damping{0, 0};  // Rayleigh
};

/// Motion of a hyperelastic solid, with forward derivatives by parameters. Trapezoidal rule,
///   M (v' - v)/h + a M (v + v')/2 + (f(x) + f(x'))/2 + b (f(x') - f(x))/h = loads,
///   x' = x + h (v + v')/2,
/// of second order and without damping of its own. The term of b is the mean over the step of
/// b df/dt = b K v: Rayleigh damping with the tangent as it is, solved for exactly.
class SolidMotion {
 public:
  /// Starts at rest at x; `slopes` are the parameters by which derivatives are carried along.
  /// `solver` outlives this, and nobody else uses it meanwhile.
  SolidMotion(SolidSolver& solver, SolidMotionProblem problem, const Eigen::Matrix3Xd& x,
              double step, std::vector<SolidSlope> slopes);

  /// One step; false where Newton finds no solution.
  bool advance();

  const Eigen::Matrix3Xd& positions() const { return x_; }
  const Eigen::Matrix3Xd& velocities() const { return v_; }
  double energy() const;  // J, of strain and motion less the work of the loads
  /// Of positions by parameter.
  const Eigen::Matrix3Xd& position_slope(int parameter) const { return dx_[parameter]; }

 private:
  /// Forces out of balance at the end of a step to x, whose forces are given.
  Eigen::Matrix3Xd imbalance(const Eigen::Matrix3Xd& x, const Eigen::Matrix3Xd& forces) const;
  bool factorise(const factor::BlockMatrix& stiffness);
  bool correct(Eigen::Matrix3Xd& x, Eigen::Matrix3Xd& forces);
  void carry_slopes(const Eigen::Matrix3Xd& x, const Eigen::Matrix3Xd& forces);
  static Eigen::Matrix3Xd times(const factor::BlockMatrix& matrix, const Eigen::Matrix3Xd& u);

  SolidSolver& solver_;
  SolidMotionProblem problem_;
  double h_;
  double now_, before_;  // shares of the forces at the end and the beginning of a step
  std::vector<SolidSlope> slopes_;
  factor::BlockMatrix volume_, mass_, stiffness_;  // m^3; kg; N/m at x_, where there are slopes
  Eigen::Matrix3Xd x_, v_, forces_;
  std::vector<Eigen::Matrix3Xd> dx_, dv_;
};

}  // namespace palpate::solid
