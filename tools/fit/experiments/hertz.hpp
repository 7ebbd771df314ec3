#pragma once

#include <filesystem>
#include <memory>

#include "rt/config/node.hpp"
#include "tools/fit/experiment.hpp"

namespace palpate::fit {

/// Kind `hertz`: a rigid ball pressed into a half space. Force as a function of depth:
///    F = 4/3 E / (1 - nu^2) sqrt(R) max(d - d0, 0)^(3/2)
/// (Johnson, Contact Mechanics, 1985, eq. 4.23), or with `model: linear` that of a spring with the
/// stiffness of Hertz' chord to the largest fitted depth h: sqrt(R h) (d - d0) instead of the
/// power.
///
/// Columns: `depth` and `force` (both positive in compression), or the ball's centre at first
/// contact `centre_x|y|z`, outward normal `normal_x|y|z`, ball's centre `position_x|y|z` and force
/// on the object's surroundings `force_x|y|z`, from which depth and force are taken along the
/// normal. Keys: geometry.radius; poisson_ratio (0.5), which is not identifiable together with E
/// from force alone; contact_offset: free | none; deviation (0.01 of the range). Parameters:
/// young_modulus, poisson_ratio (known), NAME.contact_offset (m).
std::unique_ptr<Experiment> make_hertz(const config::Node& node,
                                       const std::filesystem::path& folder);

}  // namespace palpate::fit
