#pragma once

#include "rt/registry/registry.hpp"

namespace palpate::registry {

/// Names in the slot `estimation` of the published methods (core/published_sensing), which serve as
/// baselines.
const std::vector<std::string>& published_sensing_names();

/// The estimator `name`, from the keys of `node`. Throws config::Error, and std::invalid_argument
/// for options that do not match the object.
std::unique_ptr<estimation::Estimator> make_published_sensing(const std::string& name,
                                                              const config::Node& node,
                                                              const Context& context);

}  // namespace palpate::registry
