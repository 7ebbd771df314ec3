#pragma once

namespace palpate::bridge {

/// Why a Franka arm in this mode, as libfranka numbers them, does not obey; nullptr: it does, or
/// the mode does not say.
inline const char* halt_of_franka(int robot_mode) noexcept {
  switch (robot_mode) {
    case 3:
      return "the arm is guided by hand";
    case 4:
      return "reflex of the arm";
    case 5:
      return "user stop of the arm";
    case 6:
      return "the arm recovers from an error";
    default:
      return nullptr;
  }
}

}  // namespace palpate::bridge
