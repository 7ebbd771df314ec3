#pragma once

#include <string>
#include <vector>

#include "rt/registry/registry.hpp"

namespace palpate::registry {

/// Names of the Jacobian providers of published methods, which serve as baselines.
const std::vector<std::string>& published_providers();

/// The provider `name` of that list, from the other keys of `node`.
std::unique_ptr<control::JacobianProvider> make_published_provider(const std::string& name,
                                                                   const config::Node& node,
                                                                   const Context& context,
                                                                   shape::Feature& feature);

}  // namespace palpate::registry
