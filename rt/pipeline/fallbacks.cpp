#include "rt/pipeline/fallbacks.hpp"

#include <initializer_list>

#include "rt/registry/fallbacks.hpp"

namespace palpate::pipeline {
namespace {

std::unique_ptr<Replacement> make_replacement(const config::Node& root,
                                              std::initializer_list<const char*> slots,
                                              const Slots& present, const ShapeSnapshot& snapshot) {
  config::Node wanted = root;
  bool any = false;
  for (const char* slot : slots) {
    const config::Node section = root.child(slot);
    if (!section.has("fallback")) continue;
    wanted = wanted.changed(slot, section.child("fallback").dump(), true,
                            std::string("fallback of ") + slot);
    any = true;
  }
  if (!any) return nullptr;
  return std::make_unique<Replacement>(root, wanted, present, snapshot);
}

}  // namespace

Fallbacks::Fallbacks(const config::Node& root, const Slots& present,
                     const ShapeSnapshot& snapshot) {
  mechanics.components = make_replacement(root, {"estimation", "deformation"}, present, snapshot);
  if (registry::has_fallback(root.child("feature"))) {
    registry::check_feature(root.child("feature"), present.context);
    registry::check_differs(root.child("feature"));
  }
  feature.components = make_replacement(root, {"feature"}, present, snapshot);
  steering.components = make_replacement(root, {"control"}, present, snapshot);
}

}  // namespace palpate::pipeline
