#pragma once

#include "core/frames/arm_frames.hpp"

namespace palpate::frames {

/// Why the measurements of an arm contradict its frames; "" if nothing shows that. An
/// inertial unit whose hand rests measures gravity, in the direction that X_EI and the reported
/// pose of the flange give; an error of mounting below 30 degrees is not noticed here.
const char* frame_contradiction(const ArmMeasurements& arm) noexcept;

}  // namespace palpate::frames
