#pragma once

#include <string>

#include "core/elasticity/incremental/solver_options.hpp"

namespace palpate::bench {

/// Who computes the factors, as palpated reads deformation.factor: "own", or "cholmod" in a build
/// with SuiteSparse; throws std::invalid_argument otherwise.
void choose_factor(const std::string& name, elasticity::SolverOptions& solver);

}  // namespace palpate::bench
