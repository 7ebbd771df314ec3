#include "core/elasticity/incremental/refactor_job.hpp"

#include <algorithm>

namespace palpate::elasticity {

RefactorJob::RefactorJob(const NumberedBody& body, const SolverOptions& options,
                         const std::vector<mesh::PointWeights>& samples)
    : factor(body, options, samples),
      pattern_(body.pattern),
      tangents_(make_element_tangents(body.elements, pattern_)),
      matrix_(pattern_),
      warped_(pattern_),
      mass_(mass_blocks(body.elements, pattern_)),
      factorisation_(options.make_factor(body.supernodes)),
      response_(body.body, body.elements, pattern_,
                collision::free_directions(options.contact.obstacles)),
      stress_(make_stress_evaluator(body.elements)) {
  snapshot.positions = body.body.mesh.nodes;
  snapshot.loads.setZero(3, body.node_count());
  sensitivity.resize(
      body.node_count(),
      static_cast<int>(collision::free_directions(options.contact.obstacles).size()));
  const std::size_t most = samples.empty() ? 0 : options.contact.most;
  contact_samples.reserve(most);
  snapshot.touching.reserve(most);
}

/// Assembles the static tangent and the matrix of the damping.
void RefactorJob::assemble(Tangent kind) {
  tangents_->assemble(snapshot.positions, kind, matrix_,
                      factor.step.viscous > 0 ? &warped_ : nullptr);
}

/// Converts the static tangent to that of a step.
void RefactorJob::add_step() {
  if (factor.step.viscous > 0) matrix_.add(factor.step.viscous, warped_);
  if (factor.step.inertia > 0) matrix_.add_scalar(factor.step.inertia, mass_);
}

bool RefactorJob::factorise(double shift) {
  return factorisation_->factorise(matrix_, shift) && factorisation_->is_positive(snapshot.held);
}

void RefactorJob::run() noexcept {
  sensitivity.valid = false;
  factor.regularised = false;
  stress_->evaluate(snapshot.positions, sensitivity.stress);
  assemble(Tangent::kExact);
  factor.exact = factorise();
  if (factor.exact) response_.compute(snapshot, matrix_, *factorisation_, sensitivity);
  if (factor.step.inertia > 0) {
    add_step();
    factor.exact = factorise();
  }
  factor.usable = factor.exact;
  if (!factor.usable) {
    assemble(Tangent::kSemidefinite);
    add_step();
    factor.usable = factorise();
  }
  if (!factor.usable) {
    // The body is unsupported: a weak spring at every node replaces the support.
    double largest = 0;
    for (int k = 0; k < pattern_.size(); ++k) {
      largest = std::max(largest, matrix_.block(pattern_.column_start()[k]).trace() / 3);
    }
    factor.regularised = true;
    factor.usable = factorise(1e-4 * largest);
  }
  factor.usable = factor.usable && factor.panels.assign(*factorisation_);
  if (factor.usable && !contact_samples.empty()) {
    factor.columns.fill(contact_samples, *factorisation_, snapshot.held);
  }
}

}  // namespace palpate::elasticity
