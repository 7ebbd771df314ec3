#pragma once

#include <filesystem>

#include "tools/lab/studies/study_score.hpp"

namespace palpate::studies {

/// Three panels next to each other, as in the thesis: measured cloud, estimate, and both overlaid,
/// with their errors. Viewed along +y of W, as close as the shapes allow. X_WO: pose of the object.
/// Throws std::runtime_error if rendering is unavailable.
void draw_state(const StateScore& state, const math::Pose& X_WO, const std::filesystem::path& png);

}  // namespace palpate::studies
