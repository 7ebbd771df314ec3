#pragma once

#include "core/elasticity/deformation_model.hpp"

namespace palpate::support {

/// Computes and installs the factor that the model wants, as a background thread does.
inline void refactor(elasticity::DeformationModel& model) {
  if (elasticity::Refactorisation* job = model.wanted_refactorisation()) {
    job->run();
    model.install(*job);
  }
}

}  // namespace palpate::support
