#pragma once

#include "core/elasticity/corotational_model.hpp"
#include "tests/support/refactor.hpp"
#include "tests/unit/core/elasticity/bodies.hpp"

namespace palpate::elasticity {

using support::refactor;

inline constexpr double kDt = 1e-3;  // s

inline Body bar(mesh::ElementOrder order = mesh::ElementOrder::kQuadratic) {
  return make_bar({0.2, 0.05, 0.05}, {5, 1, 1}, order);
}

/// Steps until converged; refactors in between if requested.
inline StepReport settle(DeformationModel& model, bool with_refactorisation, int steps = 400) {
  StepReport report;
  for (int i = 0; i < steps; ++i) {
    report = model.step(kDt);
    if (report.status != StepStatus::kNotConverged) break;
    if (with_refactorisation) refactor(model);
  }
  return report;
}

}  // namespace palpate::elasticity
