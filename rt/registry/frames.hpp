#pragma once

#include <optional>

#include "core/frames/arm_frames.hpp"
#include "rt/config/node.hpp"

namespace palpate::registry {

using Frames = frames::ArmFrames;  // from the section `frames`

/// Reads `frames`; throws config::Error.
Frames read_frames(const config::Node& root);

/// Reads `second_arm.frames`; empty without `second_arm`. Throws config::Error.
std::optional<Frames> read_second_frames(const config::Node& root);

}  // namespace palpate::registry
