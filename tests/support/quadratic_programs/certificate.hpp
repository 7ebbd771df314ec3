#pragma once

#include "core/math/quadratic_program.hpp"

namespace palpate::support {

/// What the header of QuadraticProgram promises about a row, computed from the program alone.
struct Scales {
  explicit Scales(const math::QuadraticProgram& program);

  double program = 0;     // distance from the unconstrained optimum to 0 and to the worst row
  Eigen::VectorXd norm;   // (a^T H^-1 a)^1/2
  Eigen::VectorXd price;  // of a unit of violation, in the row's units; infinite for hard rows
};

/// How far (u, multipliers) is from the Karush-Kuhn-Tucker conditions, which a strictly convex
/// program has one solution of. Computed in long double; all relative.
struct OptimalityError {
  double stationarity = 0;     // of H u + g + A lambda, by the size of its terms
  double feasibility = 0;      // violation of hard rows, by norm and scale
  double complementarity = 0;  // a row that presses and is not at its bound, or gives way for less
                               // than its price
  double largest() const { return std::max({stationarity, feasibility, complementarity}); }
};
OptimalityError optimality_error(const math::QuadraticProgram& program,
                                 const math::QuadraticProgramSolver& solver);

/// True where the multipliers prove that no u meets the hard rows (Farkas): their sum of normals
/// vanishes to rounding while that of the bounds is below zero, and by more than rounding could be.
bool proves_infeasibility(const math::QuadraticProgram& program,
                          const math::QuadraticProgramSolver& solver);

}  // namespace palpate::support
