#pragma once

#include <string>

#include "core/math/quadratic_program.hpp"
#include "core/math/random.hpp"

namespace palpate::support {

/// Families of random programs: regular ones and the degenerate ones that occur in a servo loop.
enum class Family {
  kPlain,          // rows around a feasible point
  kBox,            // bounds on every variable, and rows
  kRedundant,      // rows that repeat, scale, negate or add others
  kEquations,      // equations, some of them repeated, in addition to rows
  kRankDeficient,  // all rows within a subspace of one to three dimensions
  kThin,           // feasible in a slab whose width is 1e-6 of its distance
  kInfeasible,     // rows whose weighted sum is contradictory, by 1e-6 to 1 of its size
  kBadlyScaled,    // rows scaled by up to 1e6, variables by up to 1e3, either way
  kVertex,         // more rows than variables through the optimum
  kSoft,           // contradictory rows of every level, a few consistent hard ones
};
constexpr int kFamilies = 10;
std::string name(Family family);

/// A program of 1 to `variables` variables and up to `rows` rows.
math::QuadraticProgram random_program(Family family, int variables, int rows, math::Random& random);

/// The next cycle of a servo loop: g, and the bounds of inequalities, changed by the relative
/// amount `size`.
void drift(math::QuadraticProgram& program, double size, math::Random& random);

}  // namespace palpate::support
