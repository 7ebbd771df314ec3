#pragma once

#include <cstdint>

namespace palpate::ur_bridge {

inline constexpr std::int32_t kRunningMode = 7;    // robot_mode
inline constexpr std::uint32_t kPlayingState = 2;  // runtime_state: a program runs
inline constexpr std::uint32_t kPausingState = 3;  // or has been paused (4), or resumes (5)
inline constexpr std::uint32_t kResumingState = 5;

/// Why the arm does not obey, by `robot_mode` and `safety_status_bits` of RTDE; nullptr: it does.
const char* halt_of(std::int32_t robot_mode, std::uint32_t safety_bits) noexcept;

}  // namespace palpate::ur_bridge
