#include <cstdio>

#include "core/math/constants.hpp"
#include "tools/fit/held/held_plan.hpp"

namespace palpate::fit {
namespace {

using math::kPi;
constexpr char kAxes[] = "xyz";

std::string describe(const math::Vector6d& motion) {
  std::string text;
  char part[40];
  for (int k = 0; k < 6; ++k) {
    if (motion[k] == 0) continue;
    if (k < 3) {
      std::snprintf(part, sizeof(part), "%c %+.3g mm", kAxes[k], 1e3 * motion[k]);
    } else {
      std::snprintf(part, sizeof(part), "turn %c %+.3g deg", kAxes[k - 3], 180 / kPi * motion[k]);
    }
    text += (text.empty() ? "" : ", ") + std::string(part);
  }
  return text.empty() ? "hold still" : text;
}

}  // namespace

std::vector<HandMotion> candidate_motions(const HeldCell& cell, const HeldPlanOptions& options) {
  std::vector<HandMotion> motions;
  const auto add = [&](const math::Vector6d& from_rest) {
    motions.push_back({describe(from_rest), from_rest, math::Vector6d::Zero()});
  };
  add(math::Vector6d::Zero());
  const auto along = [&](int axis, double sign) {
    math::Vector6d motion = math::Vector6d::Zero();
    motion[axis] = sign * (axis < 3 ? options.amplitude : options.turn);
    return motion;
  };
  for (int axis = 0; axis < 6; ++axis)
    for (double sign : {1.0, -1.0}) add(along(axis, sign));
  for (int shift = 0; shift < 3; ++shift)
    for (int turn = 3; turn < 6; ++turn)
      for (double sign : {1.0, -1.0}) add(along(shift, 1) + along(turn, sign));
  if (cell.object.body.fixed_nodes.empty()) {
    for (int axis = 3; axis < 6; ++axis) {
      for (double angle : {0.5 * kPi, -0.5 * kPi, kPi}) {
        math::Vector6d motion = math::Vector6d::Zero();
        motion[axis] = angle;
        add(motion);
      }
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    HandMotion motion;
    motion.stop[axis] = options.speed;
    char text[60];
    std::snprintf(text, sizeof(text), "stop from %c %+.3g m/s and let it ring", kAxes[axis],
                  options.speed);
    motion.name = text;
    motions.push_back(motion);
  }
  return motions;
}

}  // namespace palpate::fit
