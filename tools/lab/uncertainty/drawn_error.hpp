#pragma once

#include <filesystem>

#include "tools/lab/runs/experiments.hpp"
#include "tools/lab/uncertainty/distributions.hpp"
#include "tools/lab/uncertainty/latin_hypercube.hpp"

namespace palpate::uncertainty {

/// Draw `index` (1 to sample.count()) as a level of model error for this scene and this
/// configuration of palpated, named "calibrated 17", with its parameters. What an object or a
/// set-up does not have (clamp, pads, camera, payload) is not drawn and not listed. The object that
/// is larger or smaller than palpated's has its faces moved; clamp, grasp, pokes and markers on a
/// face stay on it. Throws config::Error for an invalid scene or configuration and
/// std::out_of_range for the index.
runs::Mismatch draw_mismatch(const Distributions& distributions, const LatinHypercube& sample,
                             int index, const std::filesystem::path& scene,
                             const std::filesystem::path& configuration);

}  // namespace palpate::uncertainty
