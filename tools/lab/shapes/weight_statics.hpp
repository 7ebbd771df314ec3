#pragma once

#include <Eigen/Core>

#include "tools/lab/cases/case_problem.hpp"

namespace palpate::shapes {

/// Poisson's ratio of the predictions. The recorded elastomers are nearly incompressible, but the
/// bending of a slender body depends on Young's modulus alone, and near 0.5 the elements lock: a
/// stiff cylinder of 475 nodes sags 6.5 % less than the theory of beams says, with 0.499 12.6 %.
inline constexpr double kRubberPoisson = 0.45;

enum class Law {
  kCorotational,  // the model that palpated runs
  kHyperelastic,  // core/solid, for strains beyond its range; one material only
};
const char* name_of(Law law);

/// Positions at rest (3 x n, m) of a clamped quadratic body under its weight. `mooney`: fraction of
/// the shear modulus in the second constant of Mooney and Rivlin, hyperelastic only. Throws
/// std::runtime_error if no equilibrium is found, std::invalid_argument for a hyperelastic body of
/// several materials.
Eigen::Matrix3Xd rest_under_weight(const cases::CaseProblem& problem, Law law, double mooney = 0);

/// m, largest distance of a node of palpated's incremental model, loaded over 0.5 s of 1 ms steps,
/// from that equilibrium. Throws std::runtime_error if the model does not come to rest.
double incremental_deviation(const cases::CaseProblem& problem, const Eigen::Matrix3Xd& positions);

}  // namespace palpate::shapes
