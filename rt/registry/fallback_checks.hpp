#pragma once

#include "rt/registry/registry.hpp"

namespace palpate::registry {

/// Whether the section `node` of a slot contains a fallback section.
bool has_fallback(const config::Node& node);

/// Checks that a fallback can replace the component of `node`; each throws config::Error naming the
/// mismatch. For any slot: a different component, or the same with other parameters.
void check_differs(const config::Node& node);
/// Same sensor.
void check_sensor(const config::Node& node, const Context& context);
/// Same kind and points, so that a target remains valid.
void check_feature(const config::Node& node, const Context& context);

}  // namespace palpate::registry
