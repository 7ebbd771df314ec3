#include "core/control/guarded_motion.hpp"
#include "core/control/jacobian_providers.hpp"
#include "core/control/quadratic_program.hpp"
#include "core/control/twist_law.hpp"
#include "core/math/constants.hpp"
#include "rt/registry/box.hpp"
#include "rt/registry/slot.hpp"

namespace palpate::registry {
namespace {

using config::OptionTable;
using control::MarkerObserver;
using control::QuadraticProgramLaw;
using control::TwistLawOptions;
using math::kDegree;

OptionTable<control::DeadBand::Options> dead_band_options(
    const control::DeadBand::Options& defaults) {
  using Options = control::DeadBand::Options;
  return OptionTable<Options>(defaults)
      .number("dead_band_mm", "mm", "Position error within which the hand rests", {0, 1000},
              &Options::position, 1e-3)
      .number("dead_band_deg", "degrees", "Angle error within which the hand rests", {0, 180},
              &Options::angle, kDegree);
}

OptionTable<TwistLawOptions> twist_law_options(const TwistLawOptions& defaults) {
  using Options = TwistLawOptions;
  return OptionTable<Options>(defaults)
      .number("gain", "1/s", "Fraction of the error that is corrected per second", {1e-3, 50},
              &Options::gain)
      .number("linear_speed", "m/s", "Largest speed of the origin of G", {1e-4, 10},
              &Options::linear_speed)
      .number("angular_speed", "rad/s", "Largest angular speed of G", {1e-4, 10},
              &Options::angular_speed)
      .part(dead_band_options(defaults.dead_band), &Options::dead_band)
      .number(
          "characteristic_length", "m",
          "Displacement that has the same weight as a rotation by 1 rad", {1e-3, 10},
          [](auto& options) -> auto& { return options.inverse.length; });
}

TwistLawOptions read_twist_law(const config::Node& node, const Context& context) {
  const std::string preset =
      node.choice({"preset", "",
                   "Set of default values; thesis: 0.25 1/s, 1 m/s, 0.5 rad/s, dead band of 5 mm "
                   "and 1 degree"},
                  {"palpate", "thesis"}, "palpate");
  TwistLawOptions options = node.read(
      twist_law_options(preset == "thesis" ? TwistLawOptions::thesis() : TwistLawOptions()));
  if (read_moving_arms(node, context) == MovingArms::kBoth) options.inverse.grasps = 2;
  return options;
}

OptionTable<control::MotionLimitOptions> motion_limit_options() {
  using Options = control::MotionLimitOptions;
  return OptionTable<Options>()
      .number("linear_acceleration", "m/s^2", "Largest acceleration of the origin of G",
              {1e-3, 100}, &Options::linear_acceleration)
      .number("angular_acceleration", "rad/s^2", "Largest angular acceleration of G", {1e-3, 100},
              &Options::angular_acceleration)
      .number("force", "N", "Largest component of the force of a grasp", {1e-3, 1e4},
              &Options::force)
      .number("torque", "N m", "Largest component of the torque of a grasp", {1e-4, 1e4},
              &Options::torque)
      .number("stress", "Pa",
              "Largest von Mises stress of the most loaded elements; absent: no limit", {1, 1e9},
              &Options::stress)
      .optional()
      .number("stretch", "",
              "Largest principal stretch of the most loaded elements; absent: no limit",
              {1.001, 10}, &Options::stretch)
      .optional()
      .number("strain_margin", "",
              "Margin for estimation errors, as a fraction of the limits of stress and stretch",
              {0, 0.9}, &Options::strain_margin)
      .number(
          "clearance_deviations", "",
          "Number of standard deviations of the estimated shape that are added to the clearance "
          "of obstacles",
          {0, 10}, &Options::clearance_deviations)
      .number("fallback_deviation", "m",
              "Standard deviation of the shape that is assumed where the estimator reports none",
              {0, 0.1}, &Options::fallback_deviation)
      .alias("untold_deviation")
      .number("damper", "1/s",
              "Fraction of the remaining distance per second with which a limit is approached at "
              "most",
              {0.01, 1e3}, &Options::damper)
      .number("pivot", "",
              "Fraction of the first smallest pivot of the stiffness below which motion slows "
              "down, because the object is near buckling",
              {0, 1}, &Options::pivot);
}

OptionTable<control::SlipCone> slip_options() {
  using Options = control::SlipCone;
  return OptionTable<Options>()
      .number("pinch", "N", "Force with which the fingers press the object", {0, 1e4},
              &Options::pinch)
      .required()
      .number("friction", "", "Coulomb friction coefficient", {1e-3, 10}, &Options::friction)
      .number("lever", "m",
              "Lever arm of the friction against rotation about the normal: two thirds of the "
              "radius of a round patch",
              {1e-4, 1}, &Options::lever)
      .number("width", "m", "Distance from finger to finger", {1e-3, 10}, &Options::width)
      .number("sticking", "",
              "Fraction of the patch that must not slip; the remaining friction bears the load",
              {0, 0.99}, &Options::sticking)
      .vector3("normal", "", "Direction in which the fingers press, in G", {-1, 1},
               &Options::normal_G)
      .required();
}

control::MotionLimitOptions read_motion_limits(const config::Node& node) {
  control::MotionLimitOptions limits = node.read(motion_limit_options());
  if (node.has("slip"))
    limits.slip = node.child({"slip", "",
                              "Grip of the hand, beyond which the object would slip; absent: slip "
                              "is not modelled"})
                      .read(slip_options());
  if (node.has("workspace")) {
    const Box box = node.child({"workspace", "", "Box in which the origin of G stays"})
                        .read(box_options("in O", kAnywhere));
    limits.workspace_lower = box.lower;
    limits.workspace_upper = box.upper;
  }
  for (const char* former : {"obstacles", "clearance"})
    if (node.has(former))
      node.fail(former,
                "is set for each obstacle; allowed: the list obstacles of the configuration, with "
                "keys clearance, allowed and force");
  return limits;
}

control::FlangeBox flange_box(const Frames& frames, const control::GateLimits& gate) {
  return {gate.workspace_lower, gate.workspace_upper, frames.X_WO,
          frames.X_EG.inverse().translation()};
}

std::unique_ptr<control::ControlLaw> make_quadratic_program(const config::Node& node,
                                                            const Context& context) {
  const TwistLawOptions options = read_twist_law(node, context);
  QuadraticProgramLaw::Limited limited =
      node.read(OptionTable<QuadraticProgramLaw::Limited>().number(
          "smoothness", "", "Weight of the change of the command relative to that of the error",
          {0, 1e3}, &QuadraticProgramLaw::Limited::smoothness));
  limited.body = &context.object->body;
  limited.limits = read_motion_limits(
      node.child_or_empty({"limits", "", "Limits that the law quadratic_program enforces"}));
  for (const ConfiguredObstacle& obstacle : context.object->obstacles)
    limited.limits.obstacles.push_back(obstacle.limited);
  limited.limits.linear_speed = options.linear_speed;
  limited.limits.angular_speed = options.angular_speed;
  limited.limits.flange[0] = flange_box(context.frames, context.gate[0]);
  if (context.second_frames)
    limited.limits.flange[1] = flange_box(*context.second_frames, context.gate[1]);
  if (read_commands_joints(node, context)) limited.limits.joints = context.arm_model->limits;
  const MovingArms moving = read_moving_arms(node, context);
  if (moving == MovingArms::kSecond) limited.grasps = {1};
  if (moving == MovingArms::kBoth) limited.grasps = {0, 1};
  return std::make_unique<QuadraticProgramLaw>(options, limited);
}

OptionTable<contact::IndentationFit::Options> indentation_options() {
  using Options = contact::IndentationFit::Options;
  return OptionTable<Options>()
      .number("exponent", "",
              "Exponent of the force over the indentation: 1.5 for a ball on a thick object, 1 for "
              "a flat tip",
              {1, 3}, &Options::exponent)
      .number(
          "exponent_deviation", "",
          "Standard deviation of the exponent; 0: it is exact, which makes the deviation of the "
          "touched point too small on most objects",
          {0, 1}, &Options::exponent_deviation)
      .number("bias_deviation", "N",
              "Standard deviation of the change of the force without contact since the approach "
              "began",
              {1e-4, 10}, &Options::bias_deviation)
      .number(
          "force_play", "N",
          "Largest rise of the force before the sensor's reading follows, by friction of cables",
          {0, 10}, &Options::force_play);
}

OptionTable<control::GuardedMotion::Options> guarded_motion_options() {
  using Options = control::GuardedMotion::Options;
  return OptionTable<Options>()
      .number("speed", "m/s", "Speed of the approach, where the request gives none", {1e-5, 0.1},
              &Options::speed)
      .number("distance", "m",
              "Distance after which an approach ends without contact, where the request gives none",
              {1e-3, 1}, &Options::distance)
      .number("retreat", "m",
              "Distance from the touched point after backing off, where the request gives none",
              {0, 1}, &Options::retreat)
      .number("acceleration", "m/s^2", "Acceleration of a guarded motion", {1e-3, 10},
              &Options::acceleration)
      .vector3("tip_in_grasp", "m", "Centre of the tip that touches, in G", {-1, 1},
               &Options::tip_G)
      .number("tip_radius", "m", "Radius of the tip; 0: a point", {0, 0.1}, &Options::tip_radius)
      .number("baseline_time", "s", "Time at rest over which the force without contact is averaged",
              {0.01, 10}, &Options::baseline_time)
      .number("hold_time", "s", "Least time at rest between approach and retreat", {0, 10},
              &Options::hold_time)
      .number("force_smoothing", "s",
              "Time constant of the force that is compared with the threshold", {1e-3, 1},
              &Options::force_smoothing)
      .number("force_limit", "N",
              "Largest threshold that a request may have; above this force the hand backs off at "
              "once",
              {0.01, 1e3}, &Options::force_limit)
      .number("force_delay", "s", "Delay of the force relative to the pose", {0, 0.1},
              &Options::force_delay)
      .part(indentation_options(), &Options::fit);
}

std::unique_ptr<control::ControlLaw> make_guarded_motion(
    const control::GuardedMotion::Options& options, const config::Node& node,
    const Context& context) {
  if (read_moving_arms(node, context) != MovingArms::kFirst)
    node.fail("law", "guarded_motion moves the first arm only; see moves");
  return std::make_unique<control::GuardedMotion>(options, context.gate[0].linear_speed);
}

template <class Law>
std::unique_ptr<control::ControlLaw> make_twist_law(const config::Node& node,
                                                    const Context& context) {
  return std::make_unique<Law>(read_twist_law(node, context));
}

std::unique_ptr<control::JacobianProvider> make_fem_jacobian(const config::Node& node,
                                                             const Context& context,
                                                             shape::Feature&) {
  const MovingArms moving = read_moving_arms(node, context);
  control::FemJacobian::Options options;
  options.grasp = moving == MovingArms::kSecond ? 1 : 0;
  options.both = moving == MovingArms::kBoth;
  return std::make_unique<control::FemJacobian>(options);
}

std::unique_ptr<control::JacobianProvider> make_kinematic_jacobian(const config::Node& node,
                                                                   const Context& context,
                                                                   shape::Feature&) {
  if (read_moving_arms(node, context) == MovingArms::kBoth)
    node.fail("provider", "kinematic models one hand, which carries the feature; use fem");
  return std::make_unique<control::KinematicJacobian>();
}

constexpr const char* kLaw = "Control law, which converts the error of the feature into a motion";

}  // namespace

MovingArms read_moving_arms(const config::Node& control, const Context& context) {
  const std::string arms = control.choice({"moves", "", "Arms that the controller moves"},
                                          {"first", "second", "both"}, "first");
  if (arms == "first") return MovingArms::kFirst;
  if (!context.second_frames) control.fail("moves", arms + ": there is no section second_arm");
  return arms == "second" ? MovingArms::kSecond : MovingArms::kBoth;
}

bool read_commands_joints(const config::Node& control, const Context& context) {
  if (control.choice({"command", "",
                      "Published command: the twist of the flange, or joint velocities (law "
                      "quadratic_program, section robot)"},
                     {"twist", "joint_velocity"}, "twist") == "twist")
    return false;
  if (!context.arm_model)
    control.fail("command", "joint_velocity needs the arm's joints: section robot with key urdf");
  if (read_moving_arms(control, context) != MovingArms::kFirst)
    control.fail("command", "joint_velocity moves the first arm only; see moves");
  if (control.text({"law", "", kLaw}) != "quadratic_program")
    control.fail("command", "joint_velocity needs the law quadratic_program");
  return true;
}

control::DiscrepancyPolicy read_discrepancy_policy(const config::Node& control) {
  using Options = control::DiscrepancyPolicy::Options;
  using Action = control::DiscrepancyAction;
  return control::DiscrepancyPolicy(control.read(
      OptionTable<Options>()
          .choice<Action>(
              "on_discrepancy",
              "Motion while the wrenches contradict the model: unchanged, slowed to "
              "discrepancy_speed, or stopped; as before once that has ended",
              {{"continue", Action::kContinue}, {"slow", Action::kSlow}, {"stop", Action::kStop}},
              &Options::action)
          .number("discrepancy_speed", "",
                  "Fraction of the commanded speed for on_discrepancy: slow", {0, 1},
                  &Options::speed)));
}

std::unique_ptr<control::JacobianProvider> make_jacobian_provider(const config::Node& node,
                                                                  const Context& context,
                                                                  shape::Feature& feature) {
  static const auto slot =
      Slot<plugin::PluginJacobianProvider, shape::Feature&>(
          {"provider", "", "Method that provides the feature's Jacobian"},
          &plugin::PluginRegistrar::jacobian_providers)
          .add("fem", "Jacobian from the mechanics of the object", make_fem_jacobian)
          .add("kinematic", "Jacobian of a feature that is rigid with the hand",
               make_kinematic_jacobian);
  read_moving_arms(node, context);  // an error also where the provider does not use it
  return slot.make(node, context, feature);
}

std::unique_ptr<control::ControlLaw> make_control_law(const config::Node& node,
                                                      const Context& context,
                                                      const shape::Feature& feature) {
  static const auto slot =
      Slot<plugin::PluginControlLaw>({"law", "", kLaw}, &plugin::PluginRegistrar::control_laws)
          .add("proportional_twist", "Twist proportional to the error of the feature",
               make_twist_law<control::ProportionalTwist>)
          .add("dual_quaternion", "Twist along the screw motion that corrects a pose",
               make_twist_law<control::DualQuaternion>)
          .add("quadratic_program", "Twist or joint velocities that keep limits",
               make_quadratic_program)
          .add("guarded_motion",
               "Motion on request along a direction until a contact, whose place and stiffness it "
               "reports; follows no target",
               guarded_motion_options(), make_guarded_motion);
  auto law = slot.make(node, context);
  try {
    law->configure_for(feature);
  } catch (const std::invalid_argument& error) {
    node.fail("law", node.text("law") + ": " + error.what());
  }
  return law;
}

std::unique_ptr<MarkerObserver> make_marker_observer(const config::Node& node,
                                                     const Context& context,
                                                     const shape::Feature& feature) {
  struct Vision {
    std::optional<MarkerObserver::Kind> kind;
  };
  using Kind = decltype(Vision::kind);
  const Kind kind =
      node.read(OptionTable<Vision>()
                    .choice<Kind>("vision",
                                  "Source of the feature's value: the model, tracked markers, or "
                                  "markers and the model while they are hidden",
                                  {{"none", Kind()},
                                   {"markers", MarkerObserver::Kind::kHeld},
                                   {"markers_and_model", MarkerObserver::Kind::kOffset}},
                                  &Vision::kind)
                    .alias("sight"))
          .kind;
  if (!kind) return nullptr;
  using Options = MarkerObserver::Options;
  Options options =
      node.read(OptionTable<Options>()
                    .number("vision_timeout", "s",
                            "Time without a message of markers after which vision is lost",
                            {0.001, 100}, &Options::patience)
                    .alias("sight_patience"));
  options.kind = *kind;
  return std::make_unique<MarkerObserver>(context.object->body.mesh, feature.rest_points(),
                                          options);
}

}  // namespace palpate::registry
