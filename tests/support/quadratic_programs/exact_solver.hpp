#pragma once

#include <optional>

#include "core/math/quadratic_program.hpp"

namespace palpate::support {

/// Solution in exact arithmetic, by CGAL's solver (another method, another code): soft rows get
/// slack variables at their prices. Empty if the hard rows are infeasible.
std::optional<Eigen::VectorXd> exact_answer(const math::QuadraticProgram& program);

}  // namespace palpate::support
