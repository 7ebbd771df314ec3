#pragma once

#include <filesystem>
#include <string>

#include "tools/evaluate/thesis_score.hpp"

namespace palpate::evaluate {

/// Three panels side by side, as the thesis shows them: measured cloud, estimate, and both in one.
/// Seen from the side of W's -y, whatever the object's size. Throws std::runtime_error where
/// nothing can be drawn.
void draw_state(const StateShapes& shapes, const math::Pose& X_WO, const std::string& title,
                const std::filesystem::path& png);

}  // namespace palpate::evaluate
