#pragma once

#include <optional>

#include "core/math/quadratic_program.hpp"

namespace palpate::support {

/// The answer in exact arithmetic, by CGAL's solver (another method, another code): soft rows get
/// slack variables at their prices. Nothing where the hard rows contradict each other.
std::optional<Eigen::VectorXd> exact_answer(const math::QuadraticProgram& program);

}  // namespace palpate::support
