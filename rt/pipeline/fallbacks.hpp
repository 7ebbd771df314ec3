#pragma once

#include <memory>

#include "rt/pipeline/replacement.hpp"

namespace palpate::pipeline {

/// Components that wait beside those in the slots for one of them to fault; while they are in use
/// the first ones wait here.
struct Fallback {
  std::unique_ptr<Replacement> components;  // nullptr: none is configured
  bool in_use = false;
};

/// What the key `fallback` of estimation and deformation, which change together, of feature and of
/// control names: a section as that slot's own. Built, given the shape and warmed up beforehand.
/// (Those of sensing and contact, which have lists, are part of the slots.)
struct Fallbacks {
  /// For any thread but the loop's. Throws config::Error, also for unknown keys.
  Fallbacks(const config::Node& root, const Slots& present, const ShapeSnapshot& snapshot);

  bool in_use() const noexcept { return mechanics.in_use || feature.in_use || steering.in_use; }

  Fallback mechanics;
  Fallback feature;  // with a controller of its own; not both this and the controller's at a time
  Fallback steering;
};

}  // namespace palpate::pipeline
