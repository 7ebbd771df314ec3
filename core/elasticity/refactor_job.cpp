#include "core/elasticity/refactor_job.hpp"

#include <algorithm>

namespace palpate::elasticity {

RefactorJob::RefactorJob(const Body& body, const ElementSet& elements, const Supernodes& supernodes,
                         PanelPrecision precision, math::Team& team)
    : factor(supernodes, precision, team),
      elements_(elements),
      pattern_(supernodes.pattern()),
      matrix_(pattern_),
      factorisation_(supernodes),
      response_(body, elements, pattern_) {
  snapshot.positions = body.mesh.nodes;
  snapshot.loads.setZero(3, body.mesh.node_count());
  sensitivity.resize(body.mesh.node_count());
}

bool RefactorJob::factorise(Tangent kind, const StepFactors& step) {
  matrix_.set_zero();
  for (int e = 0; e < elements_.element_count(); ++e) {
    elements_.stiffness(e, snapshot.positions, kind, step.viscous, element_matrix_);
    matrix_.add(e, element_matrix_);
    if (step.inertia > 0) {
      elements_.mass(e, element_matrix_);
      matrix_.add_scalar(e, step.inertia, element_matrix_);
    }
  }
  return factorisation_.factorise(matrix_) && factorisation_.is_positive(snapshot.held);
}

void RefactorJob::run() noexcept {
  sensitivity.valid = false;
  factor.regularised = false;
  factor.exact = factorise(Tangent::kExact, {});
  if (factor.exact) response_.compute(snapshot, matrix_, factorisation_, sensitivity);
  if (factor.step.inertia > 0) factor.exact = factorise(Tangent::kExact, factor.step);
  factor.usable = factor.exact || factorise(Tangent::kSemidefinite, factor.step);
  if (!factor.usable) {
    // Nothing holds the body: a weak spring at every node takes the place of the missing support.
    double largest = 0;
    for (int k = 0; k < pattern_.size(); ++k) {
      largest = std::max(largest, matrix_.block(pattern_.column_start()[k]).trace() / 3);
    }
    factor.regularised = true;
    factor.usable = factorisation_.factorise(matrix_, 1e-4 * largest) &&
                    factorisation_.is_positive(snapshot.held);
  }
  factor.usable = factor.usable && factor.panels.assign(factorisation_);
}

}  // namespace palpate::elasticity
