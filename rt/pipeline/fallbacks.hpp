#pragma once

#include <memory>

#include "rt/pipeline/replacement.hpp"

namespace palpate::pipeline {

/// Standby components that replace those in the slots after a fault; while they are active the
/// original ones are stored here.
struct Fallback {
  std::unique_ptr<Replacement> components;  // nullptr: not configured
  bool in_use = false;
};

/// Components named by the key `fallback` of estimation and deformation, which change together, of
/// feature and of control: a section like that of the slot itself. Built, given the shape and
/// warmed up in advance. (Those of sensing and contact, which have lists, belong to the slots.)
struct Fallbacks {
  /// For any thread but the loop's. Throws config::Error, also for unknown keys.
  Fallbacks(const config::Node& root, const Slots& present, const ShapeSnapshot& snapshot);

  bool in_use() const noexcept { return mechanics.in_use || feature.in_use || steering.in_use; }

  Fallback mechanics;
  /// With its own controller; this and the controller's fallback are never active together.
  Fallback feature;
  Fallback steering;
};

}  // namespace palpate::pipeline
