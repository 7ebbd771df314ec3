#include <algorithm>

#include "core/control/dual_quaternion.hpp"
#include "core/control/fem_jacobian.hpp"
#include "core/control/kinematic_jacobian.hpp"
#include "core/control/proportional_twist.hpp"
#include "core/control/quadratic_program.hpp"
#include "rt/component/published_control_registry.hpp"

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

control::Obstacle read_obstacle(const config::Node& node) {
  control::Obstacle obstacle;
  obstacle.center_O = node.vector3("center", {-100, 100});
  obstacle.radius = node.number("radius", {1e-4, 100});
  return obstacle;
}

control::MotionLimitOptions read_motion_limits(const config::Node& node) {
  control::MotionLimitOptions limits;
  limits.linear_acceleration =
      node.number("linear_acceleration", {1e-3, 100}, limits.linear_acceleration);
  limits.angular_acceleration =
      node.number("angular_acceleration", {1e-3, 100}, limits.angular_acceleration);
  limits.force = node.number("force", {1e-3, 1e4}, limits.force);
  limits.torque = node.number("torque", {1e-4, 1e4}, limits.torque);
  if (node.has("stress")) limits.stress = node.number("stress", {1, 1e9});
  if (node.has("stretch")) limits.stretch = node.number("stretch", {1.001, 10});
  limits.strain_margin = node.number("strain_margin", {0, 0.9}, limits.strain_margin);
  limits.clearance = node.number("clearance", {0, 1}, limits.clearance);
  limits.damper = node.number("damper", {0.01, 1e3}, limits.damper);
  limits.pivot = node.number("pivot", {0, 1}, limits.pivot);
  if (node.has("slip")) {
    const config::Node slip = node.child("slip");
    limits.slip.pinch = slip.number("pinch", {0, 1e4});
    limits.slip.friction = slip.number("friction", {1e-3, 10}, limits.slip.friction);
    limits.slip.lever = slip.number("lever", {1e-4, 1}, limits.slip.lever);
    limits.slip.normal_G = slip.vector3("normal", {-1, 1});
  }
  if (node.has("workspace")) {
    const config::Node workspace = node.child("workspace");
    limits.workspace_lower = workspace.vector3("lower", {-100, 100});
    limits.workspace_upper = workspace.vector3("upper", {-100, 100});
  }
  for (const config::Node& obstacle : node.list("obstacles"))
    limits.obstacles.push_back(read_obstacle(obstacle));
  return limits;
}

control::FlangeBox flange_box(const Frames& frames, const control::GateLimits& gate) {
  return {gate.workspace_lower, gate.workspace_upper, frames.X_WO,
          frames.X_EG.inverse().translation()};
}

std::unique_ptr<control::ControlLaw> make_quadratic_program(const config::Node& node,
                                                            const control::TwistLawOptions& options,
                                                            const Context& context,
                                                            MovingArms moving) {
  control::QuadraticProgramLaw::Limited limited;
  limited.body = &context.object->body;
  limited.limits = read_motion_limits(node.child_or_empty("limits"));
  limited.limits.linear_speed = options.linear_speed;
  limited.limits.angular_speed = options.angular_speed;
  limited.limits.flange[0] = flange_box(context.frames, context.gate[0]);
  if (context.second_frames)
    limited.limits.flange[1] = flange_box(*context.second_frames, context.gate[1]);
  limited.smoothness = node.number("smoothness", {0, 1e3}, limited.smoothness);
  if (read_commands_joints(node, context)) limited.limits.joints = context.arm_model->limits;
  if (moving == MovingArms::kSecond) limited.grasps = {1};
  if (moving == MovingArms::kBoth) limited.grasps = {0, 1};
  return std::make_unique<control::QuadraticProgramLaw>(options, limited);
}

}  // namespace

MovingArms read_moving_arms(const config::Node& control, const Context& context) {
  const std::string arms = control.choice("moves", {"first", "second", "both"}, "first");
  if (arms == "first") return MovingArms::kFirst;
  if (!context.second_frames) control.fail("moves", "there is no section second_arm");
  return arms == "second" ? MovingArms::kSecond : MovingArms::kBoth;
}

bool read_commands_joints(const config::Node& control, const Context& context) {
  if (control.choice("command", {"twist", "joint_velocity"}, "twist") == "twist") return false;
  if (!context.arm_model)
    control.fail("command", "joint_velocity needs the arm's joints: section robot with key urdf");
  if (read_moving_arms(control, context) != MovingArms::kFirst)
    control.fail("command", "joint_velocity moves the first arm only; see moves");
  if (control.text("law") != "quadratic_program")
    control.fail("command", "joint_velocity needs the law quadratic_program");
  return true;
}

std::unique_ptr<control::JacobianProvider> make_jacobian_provider(const config::Node& node,
                                                                  const Context& context,
                                                                  shape::Feature& feature) {
  std::vector<std::string> names = {"fem", "kinematic"};
  const std::vector<std::string>& published = published_providers();
  names.insert(names.end(), published.begin(), published.end());
  const std::string name = node.choice("provider", names);
  if (std::find(published.begin(), published.end(), name) != published.end())
    return make_published_provider(name, node, context, feature);
  const MovingArms moving = read_moving_arms(node, context);
  if (name == "kinematic") {
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
  const std::string name =
      node.choice("law", {"proportional_twist", "dual_quaternion", "quadratic_program"});
  control::TwistLawOptions options = read_twist_law(node);
  const MovingArms moving = read_moving_arms(node, context);
  if (moving == MovingArms::kBoth) options.inverse.grasps = 2;
  std::unique_ptr<control::ControlLaw> law;
  try {
    if (name == "dual_quaternion") {
      law = std::make_unique<control::DualQuaternion>(options);
    } else if (name == "quadratic_program") {
      law = make_quadratic_program(node, options, context, moving);
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
