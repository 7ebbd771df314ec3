#include "core/control/dual_quaternion.hpp"
#include "core/control/fem_jacobian.hpp"
#include "core/control/kinematic_jacobian.hpp"
#include "core/control/proportional_twist.hpp"
#include "core/control/quadratic_program.hpp"
#include "core/math/constants.hpp"
#include "rt/plugin/built_in_names.hpp"
#include "rt/registry/plugin_registry.hpp"
#include "rt/registry/registry.hpp"

namespace palpate::registry {
namespace {

using math::kDegree;

control::TwistLawOptions read_twist_law(const config::Node& node) {
  control::TwistLawOptions options;
  if (node.choice(
          {"preset", "", "thesis: 0.25 1/s, 1 m/s, 0.5 rad/s, dead band of 5 mm and 1 degree"},
          {"palpate", "thesis"}, "palpate") == "thesis") {
    options = control::TwistLawOptions::thesis();
  }
  options.gain = node.number({"gain", "1/s", "share of the error that is made up for in a second"},
                             {1e-3, 50}, options.gain);
  options.linear_speed = node.number({"linear_speed", "m/s", "largest of the origin of G"},
                                     {1e-4, 10}, options.linear_speed);
  options.angular_speed =
      node.number({"angular_speed", "rad/s", "largest of G"}, {1e-4, 10}, options.angular_speed);
  control::DeadBand::Options& band = options.dead_band;
  band.position =
      node.number({"dead_band_mm", "mm", "error of positions within which the hand rests"},
                  {0, 1000}, band.position * 1e3) *
      1e-3;
  band.angle =
      node.number({"dead_band_deg", "degrees", "error of angles within which the hand rests"},
                  {0, 180}, band.angle / kDegree) *
      kDegree;
  options.inverse.length = node.number(
      {"characteristic_length", "m", "a rotation by 1 rad weighs as much as this displacement"},
      {1e-3, 10}, options.inverse.length);
  return options;
}

control::Obstacle read_obstacle(const config::Node& node) {
  control::Obstacle obstacle;
  obstacle.center_O = node.vector3(
      {"center", "m", "of a sphere that the object stays clear of, in O"}, {-100, 100});
  obstacle.radius = node.number({"radius", "m", "of the sphere"}, {1e-4, 100});
  return obstacle;
}

control::MotionLimitOptions read_motion_limits(const config::Node& node) {
  control::MotionLimitOptions limits;
  limits.linear_acceleration =
      node.number({"linear_acceleration", "m/s^2", "largest of the origin of G"}, {1e-3, 100},
                  limits.linear_acceleration);
  limits.angular_acceleration = node.number({"angular_acceleration", "rad/s^2", "largest of G"},
                                            {1e-3, 100}, limits.angular_acceleration);
  limits.force = node.number({"force", "N", "largest of each component of the wrench of a grasp"},
                             {1e-3, 1e4}, limits.force);
  limits.torque =
      node.number({"torque", "N m", "largest of each component"}, {1e-4, 1e4}, limits.torque);
  if (node.has("stress"))
    limits.stress = node.number(
        {"stress", "Pa", "largest von Mises stress of the worst elements; absent: no limit"},
        {1, 1e9});
  if (node.has("stretch"))
    limits.stretch = node.number(
        {"stretch", "", "largest principal stretch of these; absent: no limit"}, {1.001, 10});
  limits.strain_margin = node.number({"strain_margin", "",
                                      "share of the limits of stress and stretch that is left free "
                                      "for what the estimate does not know"},
                                     {0, 0.9}, limits.strain_margin);
  limits.clearance =
      node.number({"clearance", "m", "kept from obstacles"}, {0, 1}, limits.clearance);
  limits.clearance_deviations =
      node.number({"clearance_deviations", "",
                   "standard deviations of the estimated shape that are kept beside the clearance"},
                  {0, 10}, limits.clearance_deviations);
  limits.untold_deviation =
      node.number({"untold_deviation", "m",
                   "what such a deviation is taken to be where the estimation tells none"},
                  {0, 0.1}, limits.untold_deviation);
  limits.damper = node.number(
      {"damper", "1/s", "a limit is approached no faster than by this share of what is left"},
      {0.01, 1e3}, limits.damper);
  limits.pivot = node.number({"pivot", "",
                              "share of the first smallest pivot of the stiffness below which "
                              "motion slows down, since the object nears buckling"},
                             {0, 1}, limits.pivot);
  if (node.has("slip")) {
    const config::Node slip = node.child(
        {"slip", "", "grip of the hand, beyond which the object would slip; absent: it cannot"});
    limits.slip.pinch =
        slip.number({"pinch", "N", "with which the fingers press the object"}, {0, 1e4});
    limits.slip.friction =
        slip.number({"friction", "", "of Coulomb"}, {1e-3, 10}, limits.slip.friction);
    limits.slip.lever =
        slip.number({"lever", "m",
                     "of the friction against turning about the normal: two thirds of the radius "
                     "of a round patch"},
                    {1e-4, 1}, limits.slip.lever);
    limits.slip.width =
        slip.number({"width", "m", "from finger to finger"}, {1e-3, 10}, limits.slip.width);
    limits.slip.sticking = slip.number(
        {"sticking", "",
         "share of the patch that must not slip, which leaves the rest of what friction "
         "bears for the load"},
        {0, 0.99}, limits.slip.sticking);
    limits.slip.normal_G =
        slip.vector3({"normal", "", "in which the fingers press, in G"}, {-1, 1});
  }
  if (node.has("workspace")) {
    const config::Node workspace =
        node.child({"workspace", "", "box that the origin of G stays in"});
    limits.workspace_lower = workspace.vector3({"lower", "m", "lowest corner, in O"}, {-100, 100});
    limits.workspace_upper = workspace.vector3({"upper", "m", "highest corner, in O"}, {-100, 100});
  }
  for (const config::Node& obstacle : node.list({"obstacles", "", "spheres"}))
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
  limited.limits = read_motion_limits(
      node.child_or_empty({"limits", "", "limits that the law quadratic_program keeps"}));
  limited.limits.linear_speed = options.linear_speed;
  limited.limits.angular_speed = options.angular_speed;
  limited.limits.flange[0] = flange_box(context.frames, context.gate[0]);
  if (context.second_frames)
    limited.limits.flange[1] = flange_box(*context.second_frames, context.gate[1]);
  limited.smoothness = node.number(
      {"smoothness", "", "weight of the change of the command against that of the error"}, {0, 1e3},
      limited.smoothness);
  if (read_commands_joints(node, context)) limited.limits.joints = context.arm_model->limits;
  if (moving == MovingArms::kSecond) limited.grasps = {1};
  if (moving == MovingArms::kBoth) limited.grasps = {0, 1};
  return std::make_unique<control::QuadraticProgramLaw>(options, limited);
}

}  // namespace

MovingArms read_moving_arms(const config::Node& control, const Context& context) {
  const std::string arms = control.choice({"moves", "", "arms that the controller moves"},
                                          {"first", "second", "both"}, "first");
  if (arms == "first") return MovingArms::kFirst;
  if (!context.second_frames) control.fail("moves", "there is no section second_arm");
  return arms == "second" ? MovingArms::kSecond : MovingArms::kBoth;
}

bool read_commands_joints(const config::Node& control, const Context& context) {
  if (control.choice({"command", "",
                      "what is published: the twist of the flange, or velocities of joints (law "
                      "quadratic_program, section robot)"},
                     {"twist", "joint_velocity"}, "twist") == "twist")
    return false;
  if (!context.arm_model)
    control.fail("command", "joint_velocity needs the arm's joints: section robot with key urdf");
  if (read_moving_arms(control, context) != MovingArms::kFirst)
    control.fail("command", "joint_velocity moves the first arm only; see moves");
  if (control.text({"law", "", "what makes a motion of the error"}) != "quadratic_program")
    control.fail("command", "joint_velocity needs the law quadratic_program");
  return true;
}

std::unique_ptr<control::JacobianProvider> make_jacobian_provider(const config::Node& node,
                                                                  const Context& context,
                                                                  shape::Feature& feature) {
  const MovingArms moving = read_moving_arms(node, context);
  const auto& plugins = plugins_of(context).jacobian_providers;
  const std::string name = node.choice(
      {"provider", "",
       "of the Jacobian: by the mechanics, as if the feature were rigid with the hand, or that of "
       "a plug-in"},
      plugin::with_plugins(plugin::kJacobianProviders, plugins));
  if (const auto* entry = plugin::find_plugin(plugins, name))
    return make_plugin(*entry, node, context, feature);
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

std::unique_ptr<control::MarkerObserver> make_marker_observer(const config::Node& node,
                                                              const Context& context,
                                                              const shape::Feature& feature) {
  const std::string kind = node.choice({"sight", "",
                                        "whether the feature is read off tracked markers, and "
                                        "whether the model stands in while they are hidden"},
                                       {"none", "markers", "markers_and_model"}, "none");
  if (kind == "none") return nullptr;
  control::MarkerObserver::Options options;
  if (kind == "markers_and_model") options.kind = control::MarkerObserver::Kind::kOffset;
  options.patience = node.number({"sight_patience", "s", "that sight may be lost for"},
                                 {0.001, 100}, options.patience);
  return std::make_unique<control::MarkerObserver>(context.object->body.mesh, feature.rest_points(),
                                                   options);
}

std::unique_ptr<control::ControlLaw> make_control_law(const config::Node& node,
                                                      const Context& context,
                                                      const shape::Feature& feature) {
  const auto& plugins = plugins_of(context).control_laws;
  const std::string name = node.choice({"law", "", "what makes a motion of the error"},
                                       plugin::with_plugins(plugin::kControlLaws, plugins));
  if (const auto* entry = plugin::find_plugin(plugins, name)) {
    std::unique_ptr<control::ControlLaw> own = make_plugin(*entry, node, context);
    try {
      own->configure_for(feature);
    } catch (const std::invalid_argument& error) {
      node.fail("law", name + ": " + error.what());
    }
    return own;
  }
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
  const config::Node node = root.child_or_empty(
      {"gate", "", "last limits before the robot; in second_arm those of the second"});
  control::GateLimits limits = otherwise;
  limits.linear_speed = node.number({"linear_speed", "m/s", "largest of the origin of E"},
                                    {1e-4, 10}, limits.linear_speed);
  limits.angular_speed =
      node.number({"angular_speed", "rad/s", "largest of E"}, {1e-4, 10}, limits.angular_speed);
  limits.linear_acceleration =
      node.number({"linear_acceleration", "m/s^2", "largest of the origin of E"}, {1e-3, 100},
                  limits.linear_acceleration);
  limits.angular_acceleration = node.number({"angular_acceleration", "rad/s^2", "largest of E"},
                                            {1e-3, 100}, limits.angular_acceleration);
  limits.force = node.number({"force", "N", "contact force above which the hand is stopped"},
                             {0.01, 1e4}, limits.force);
  limits.torque = node.number({"torque", "N m", "contact torque above which the hand is stopped"},
                              {0.01, 1e3}, limits.torque);
  if (node.has("workspace")) {
    const config::Node workspace =
        node.child({"workspace", "", "box that the origin of E stays in"});
    limits.workspace_lower = workspace.vector3({"lower", "m", "lowest corner, in W"}, {-100, 100});
    limits.workspace_upper = workspace.vector3({"upper", "m", "highest corner, in W"}, {-100, 100});
    if (!(limits.workspace_lower.array() < limits.workspace_upper.array()).all()) {
      workspace.fail("upper", "must be above lower on every axis");
    }
  }
  return limits;
}

}  // namespace palpate::registry
