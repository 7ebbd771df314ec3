#include "rt/registry/box.hpp"
#include "rt/registry/registry.hpp"

namespace palpate::registry {

control::GateLimits read_gate_limits(const config::Node& root,
                                     const control::GateLimits& otherwise) {
  using Limits = control::GateLimits;
  const config::Node node = root.child_or_empty(
      {"gate", "", "Last limits before the robot; in second_arm those of the second arm"});
  Limits limits = node.read(
      config::OptionTable<Limits>(otherwise)
          .number("linear_speed", "m/s", "Largest speed of the origin of E", {1e-4, 10},
                  &Limits::linear_speed)
          .number("angular_speed", "rad/s", "Largest angular speed of E", {1e-4, 10},
                  &Limits::angular_speed)
          .number("linear_acceleration", "m/s^2", "Largest acceleration of the origin of E",
                  {1e-3, 100}, &Limits::linear_acceleration)
          .number("angular_acceleration", "rad/s^2", "Largest angular acceleration of E",
                  {1e-3, 100}, &Limits::angular_acceleration)
          .number("linear_jerk", "m/s^3", "Largest jerk of the origin of E; 0: not limited",
                  {0, 1e6}, &Limits::linear_jerk)
          .number("angular_jerk", "rad/s^3", "Largest angular jerk of E; 0: not limited", {0, 1e6},
                  &Limits::angular_jerk)
          .number("force", "N", "Contact force above which the hand is stopped", {0.01, 1e4},
                  &Limits::force)
          .number("torque", "N m", "Contact torque above which the hand is stopped", {0.01, 1e3},
                  &Limits::torque));
  if (node.has("workspace")) {
    const config::Node workspace =
        node.child({"workspace", "", "Box in which the origin of E stays"});
    const Box box = workspace.read(box_options("in W", kAnywhere));
    if (!(box.lower.array() < box.upper.array()).all())
      workspace.fail("upper", workspace.dump("upper") + ": must be above lower on every axis, " +
                                  workspace.dump("lower"));
    limits.workspace_lower = box.lower;
    limits.workspace_upper = box.upper;
  }
  return limits;
}

}  // namespace palpate::registry
