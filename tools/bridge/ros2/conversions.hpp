#pragma once

#include <cstdint>
#include <optional>

#include "core/math/rigid.hpp"
#include "messages.hpp"

namespace palpate::ros2_bridge {

/// us; empty for what is no time.
std::optional<std::int64_t> utime_of(const Time& stamp);
/// `utime`: us, not negative.
Time stamp_of(std::int64_t utime);

Pose pose_message(const math::Pose& X);
/// `position`: m; `wxyz`: quaternion.
Pose pose_message(const double* position, const double* wxyz);
/// Empty if it is not finite or its quaternion not of unit length.
std::optional<math::Pose> pose_of(const Pose& message);

}  // namespace palpate::ros2_bridge
