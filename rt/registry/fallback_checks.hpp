#pragma once

#include "rt/registry/registry.hpp"

namespace palpate::registry {

/// Whether the section `node` of a slot names a fallback as a section of its own.
bool has_fallback(const config::Node& node);

/// What a fallback must be to stand in for the component of `node`, which has one; each throws
/// config::Error that names what does not fit.
/// Of any slot: another component, or the same with other parameters.
void check_differs(const config::Node& node);
/// Of the same sensor.
void check_sensor(const config::Node& node, const Context& context);
/// Of the same kind and points, so that a target stays what it was.
void check_feature(const config::Node& node, const Context& context);

}  // namespace palpate::registry
