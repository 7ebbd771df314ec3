#pragma once

#include <filesystem>

#include "tools/lab/studies/study_score.hpp"

namespace palpate::studies {

/// Three panels side by side, as the thesis shows them: measured cloud, estimate, and both in one,
/// with their errors. Seen from the side of W's -y, as near as the shapes allow. X_WO: where the
/// object lies. Throws std::runtime_error where nothing can be drawn.
void draw_state(const StateScore& state, const math::Pose& X_WO, const std::filesystem::path& png);

}  // namespace palpate::studies
