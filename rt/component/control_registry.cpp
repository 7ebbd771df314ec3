#include "core/control/dual_quaternion.hpp"
#include "core/control/fem_jacobian.hpp"
#include "core/control/kinematic_jacobian.hpp"
#include "core/control/proportional_twist.hpp"
#include "rt/component/registry.hpp"

namespace palpate::component {
namespace {

constexpr double kDegree = 0.017453292519943295;

control::TwistLawOptions read_twist_law(const config::Node& node) {
  control::TwistLawOptions options;
  if (node.choice("preset", {"palpate", "thesis"}, "palpate") == "thesis") {
    options = control::TwistLawOptions::thesis();
  }
  options.gain = node.number("gain", {1e-3, 50}, options.gain);
  options.linear_speed = node.number("linear_speed", {1e-4, 10}, options.linear_speed);
  options.angular_speed = node.number("angular_speed", {1e-4, 10}, options.angular_speed);
  control::DeadBand::Options& band = options.dead_band;
  band.position = node.number("dead_band_mm", {0, 1000}, band.position * 1e3) * 1e-3;
  band.angle = node.number("dead_band_deg", {0, 180}, band.angle / kDegree) * kDegree;
  options.inverse.length = node.number("characteristic_length", {1e-3, 10}, options.inverse.length);
  return options;
}

}  // namespace

MovingArms read_moving_arms(const config::Node& control, const Context& context) {
  const std::string arms = control.choice("moves", {"first", "second", "both"}, "first");
  if (arms == "first") return MovingArms::kFirst;
  if (!context.second_frames) control.fail("moves", "there is no section second_arm");
  return arms == "second" ? MovingArms::kSecond : MovingArms::kBoth;
}

std::unique_ptr<control::JacobianProvider> make_jacobian_provider(const config::Node& node,
                                                                  const Context& context) {
  const MovingArms moving = read_moving_arms(node, context);
  if (node.choice("provider", {"fem", "kinematic"}) == "kinematic") {
    if (moving == MovingArms::kBoth)
      node.fail("provider", "kinematic knows one hand, which carries the feature; use fem");
    return std::make_unique<control::KinematicJacobian>();
  }
  control::FemJacobian::Options options;
  options.grasp = moving == MovingArms::kSecond ? 1 : 0;
  options.both = moving == MovingArms::kBoth;
  return std::make_unique<control::FemJacobian>(options);
}

std::unique_ptr<control::ControlLaw> make_control_law(const config::Node& node,
                                                      const Context& context,
                                                      const shape::Feature& feature) {
  const std::string name = node.choice("law", {"proportional_twist", "dual_quaternion"});
  control::TwistLawOptions options = read_twist_law(node);
  if (read_moving_arms(node, context) == MovingArms::kBoth) options.inverse.grasps = 2;
  std::unique_ptr<control::ControlLaw> law;
  try {
    if (name == "dual_quaternion") {
      law = std::make_unique<control::DualQuaternion>(options);
    } else {
      law = std::make_unique<control::ProportionalTwist>(options);
    }
    law->configure_for(feature);
  } catch (const std::invalid_argument& error) {
    node.fail("law", error.what());
  }
  return law;
}

control::GateLimits read_gate_limits(const config::Node& root,
                                     const control::GateLimits& otherwise) {
  const config::Node node = root.child_or_empty("gate");
  control::GateLimits limits = otherwise;
  limits.linear_speed = node.number("linear_speed", {1e-4, 10}, limits.linear_speed);
  limits.angular_speed = node.number("angular_speed", {1e-4, 10}, limits.angular_speed);
  limits.linear_acceleration =
      node.number("linear_acceleration", {1e-3, 100}, limits.linear_acceleration);
  limits.angular_acceleration =
      node.number("angular_acceleration", {1e-3, 100}, limits.angular_acceleration);
  limits.force = node.number("force", {0.01, 1e4}, limits.force);
  limits.torque = node.number("torque", {0.01, 1e3}, limits.torque);
  if (node.has("workspace")) {
    const config::Node workspace = node.child("workspace");
    limits.workspace_lower = workspace.vector3("lower", {-100, 100});
    limits.workspace_upper = workspace.vector3("upper", {-100, 100});
    if (!(limits.workspace_lower.array() < limits.workspace_upper.array()).all()) {
      workspace.fail("upper", "must be above lower on every axis");
    }
  }
  return limits;
}

}  // namespace palpate::component
