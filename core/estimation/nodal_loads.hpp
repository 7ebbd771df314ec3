#pragma once

#include "core/estimation/estimator.hpp"

namespace palpate::estimation {

/// True if the node exists and the force is finite.
inline bool is_valid(const contact::NodalLoad& load, int node_count) noexcept {
  return load.node >= 0 && load.node < node_count && load.force.allFinite();
}

/// Sets the loads of `model` to `scale` times those of all contacts except the wrists'. False if an
/// invalid load was skipped.
inline bool load_with_contacts(const EstimationInputs& inputs, double scale,
                               elasticity::DeformationModel& model) noexcept {
  bool all_valid = true;
  model.loads().setZero();
  for (int i = 0; i < inputs.contact_count; ++i) {
    const contact::ContactLoads& contact = inputs.contacts[i];
    if (!contact.accepted || is_wrist(contact.source)) continue;
    for (const contact::NodalLoad& load : contact.loads) {
      const bool valid = is_valid(load, model.body().mesh.node_count());
      if (valid) model.loads().col(load.node) += scale * load.force;
      all_valid = all_valid && valid;
    }
  }
  return all_valid;
}

}  // namespace palpate::estimation
