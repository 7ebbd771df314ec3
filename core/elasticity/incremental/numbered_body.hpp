#pragma once

#include <vector>

#include "core/elasticity/element_forces.hpp"
#include "core/elasticity/element_set.hpp"
#include "core/factor/supernodes.hpp"

namespace palpate::elasticity {

/// A body and what follows from it once and for all parts of the solver: elements, the elimination
/// order of its unknown nodes, and the solver's numbering, which is that order with fixed nodes
/// last. Constant after construction; members refer to each other.
struct NumberedBody {
  /// `more`: of factor::elimination_order(). Throws std::invalid_argument as Body::check() and
  /// ElementSet do.
  explicit NumberedBody(Body whole, factor::Orders more = nullptr);
  NumberedBody(const NumberedBody&) = delete;
  NumberedBody& operator=(const NumberedBody&) = delete;

  int node_count() const noexcept { return static_cast<int>(numbering.size()); }
  int grasp_count() const noexcept { return static_cast<int>(body.grasps.size()); }

  Body body;
  ElementSet elements;
  factor::BlockPattern pattern;
  factor::Supernodes supernodes;
  std::vector<int> numbering;  // column of each mesh node in nodal fields
  NodalField rest;             // m, rest positions
};

}  // namespace palpate::elasticity
