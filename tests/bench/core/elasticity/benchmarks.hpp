#pragma once

#include "tests/bench/core/elasticity/scenario.hpp"

namespace palpate::bench {

/// tick/ELEMENT/NODES/MECHANICS/iterations:N in motion L, and full_cholmod/..., jacobi_pcg/...
void register_ticks(const std::vector<BarMesh>& meshes);

/// element_pass/ELEMENT/NODES, solve/..., refactorisation/...
void register_parts(const std::vector<BarMesh>& meshes);

}  // namespace palpate::bench
