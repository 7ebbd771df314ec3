#include "modes.hpp"

#include <array>
#include <utility>

namespace palpate::ur_bridge {
namespace {

// Bits of safety_status_bits that stop the arm, the gravest first. Normal (0) and reduced mode (1)
// do not.
constexpr std::array<std::pair<int, const char*>, 9> kStops{{{9, "fault of the arm"},
                                                             {8, "safety violation of the arm"},
                                                             {6, "emergency stop of the robot"},
                                                             {5, "emergency stop of the system"},
                                                             {7, "emergency stop"},
                                                             {2, "protective stop of the arm"},
                                                             {4, "safeguard stop of the arm"},
                                                             {3, "the arm is in recovery mode"},
                                                             {10, "safety stop of the arm"}}};

}  // namespace

const char* halt_of(std::int32_t robot_mode, std::uint32_t safety_bits) noexcept {
  for (const auto& [bit, reason] : kStops)
    if ((safety_bits >> bit & 1U) != 0) return reason;
  switch (robot_mode) {
    case kRunningMode:
      return nullptr;
    case 3:
      return "the arm's power is off";
    case 4:
    case 5:
      return "the arm's brakes are not released";
    case 6:
      return "the arm is guided by hand";
    default:
      return "the arm is not in its running mode";
  }
}

}  // namespace palpate::ur_bridge
