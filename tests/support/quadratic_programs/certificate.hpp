#pragma once

#include "core/math/quadratic_program.hpp"

namespace palpate::support {

/// Quantities of a row to which the guarantees of QuadraticProgram's header refer, computed from
/// the program alone.
struct Scales {
  explicit Scales(const math::QuadraticProgram& program);

  double program = 0;    // distance from the unconstrained optimum to 0 and to the worst row
  Eigen::VectorXd norm;  // (a^T H^-1 a)^1/2
  Eigen::VectorXd
      price;  // price of a unit of violation, in the row's units; infinite for hard rows
};

/// Residual of (u, multipliers) in the Karush-Kuhn-Tucker conditions, which have a unique solution
/// for a strictly convex program. Computed in long double; all relative.
struct OptimalityError {
  double stationarity = 0;     // of H u + g + A lambda, relative to its terms
  double feasibility = 0;      // violation of hard rows, relative to norm and scale
  double complementarity = 0;  // complementarity: a row with a multiplier that is not at its bound,
                               // or relaxed below its price
  double largest() const { return std::max({stationarity, feasibility, complementarity}); }
};
OptimalityError optimality_error(const math::QuadraticProgram& program,
                                 const math::QuadraticProgramSolver& solver);

/// True if the multipliers prove that no u satisfies the hard rows (Farkas): their sum of normals
/// vanishes to rounding while that of the bounds is negative, by more than rounding.
bool proves_infeasibility(const math::QuadraticProgram& program,
                          const math::QuadraticProgramSolver& solver);

}  // namespace palpate::support
