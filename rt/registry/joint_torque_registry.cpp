#include "core/sensing/joint_torque.hpp"
#include "rt/registry/arm_inertia.hpp"
#include "rt/registry/sensors.hpp"

namespace palpate::registry {
namespace {

using kinematics::BodyInertia;
using kinematics::SerialChain;
using sensing::JointTorque;

constexpr int kAny = -1;  // length of a list that is compared with the URDF

/// Lists with one value per joint; empty ones: the default of every joint.
struct JointLists {
  std::vector<double> coulomb, viscous, deviation;
};

SerialChain::Joints to_joints(const config::Node& node, const char* key,
                              const std::vector<double>& values, int count, double otherwise) {
  if (values.empty()) return SerialChain::Joints::Constant(count, otherwise);
  if (static_cast<int>(values.size()) != count)
    node.fail(key, std::to_string(values.size()) + " values; allowed: " + std::to_string(count) +
                       ", one per joint of the URDF");
  return Eigen::Map<const Eigen::VectorXd>(values.data(), count);
}

config::OptionTable<JointTorque::Options> joint_torque_options() {
  using Options = JointTorque::Options;
  return config::OptionTable<Options>()
      .flag("external",
            "Whether tau of ROBOT_STATE is the external torque, without weight, inertia and "
            "friction of the arm and its load, which are then not subtracted",
            &Options::external)
      .number("bandwidth_hz", "Hz", "Bandwidth of the observer of the external torques", {0.1, 200},
              &Options::bandwidth)
      .number("model_error", "",
              "Relative standard deviation of the weight and Coriolis torque of the model, counted "
              "from the pose of the tare",
              {0, 1}, &Options::model_error)
      .integer("tare_samples", "Number of readings averaged by a tare", {1, 100000},
               &Options::tare_samples)
      .number("max_age_ms", "ms",
              "Age of the latest joint torques beyond which the model is degraded", {1, 1e4},
              &Options::max_age, 1e-3)
      .flag("tare_at_start",
            "Tare at the start and after a reset, during which nothing may be held",
            &Options::tare_at_start)
      .part(polarity_options<Options>());
}

/// Section `friction`, as palpate-calibrate friction writes it.
sensing::JointFriction::Options read_friction(const config::Node& node, int joints) {
  using Options = sensing::JointFriction::Options;
  const config::Node section = node.child_or_empty(
      {"friction", "",
       "Friction of the joints that tau contains; absent: none, as of torques measured behind the "
       "gears"});
  Options options = section.read(
      config::OptionTable<Options>()
          .number("presliding", "rad",
                  "Rotation over which the friction of a joint builds up after it has turned back",
                  {1e-6, 0.1}, &Options::presliding)
          .number("error", "", "Relative standard deviation of the friction of a moving joint",
                  {0, 1}, &Options::error));
  const JointLists lists =
      section.read(config::OptionTable<JointLists>()
                       .numbers("coulomb", "N m", "Coulomb friction of each joint", {0, 1000}, kAny,
                                &JointLists::coulomb)
                       .optional()
                       .numbers("viscous", "N m s/rad", "Viscous friction of each joint", {0, 1000},
                                kAny, &JointLists::viscous)
                       .optional());
  options.coulomb = to_joints(section, "coulomb", lists.coulomb, joints, 0);
  options.viscous = to_joints(section, "viscous", lists.viscous, joints, 0);
  return options;
}

/// With the load on the last link.
std::vector<BodyInertia> read_links(const config::Node& node, const ArmModel& arm,
                                    const math::Pose& X_ES) {
  ArmInertia inertia = read_inertia(arm.urdf, arm.flange);
  if (node.has("payload")) {
    if (node.child("payload").has("bias"))
      node.fail("payload", "bias is an offset of a force-torque sensor; allowed: no such key");
    const sensing::PayloadParameters payload = read_payload(node);
    const math::Vector6d& i = payload.inertia;
    BodyInertia in_S{payload.mass, payload.first_moment, {}};
    in_S.rotational << i[0], i[1], i[2], i[1], i[3], i[4], i[2], i[4], i[5];
    inertia.load = BodyInertia::moved(X_ES, in_S);
  }
  inertia.links.back() += BodyInertia::moved(arm.chain.X_JE(), inertia.load);
  return inertia.links;
}

}  // namespace

std::unique_ptr<sensing::SensorModel> make_joint_torque(const config::Node& node,
                                                        const Context& context) {
  if (!context.arm_model)
    node.fail("component",
              "joint_torque: the section robot is missing, which names the arm's URDF");
  if (read_arm(node, context) == 1)
    node.fail("arm", "1: joint_torque is of the first arm, which the section robot describes");
  const ArmModel& arm = *context.arm_model;
  const int joints = arm.chain.joint_count();
  JointTorque::Options options = node.read(joint_torque_options());
  options.friction = read_friction(node, joints);
  const JointLists lists = node.read(
      config::OptionTable<JointLists>()
          .numbers("joint_deviation", "N m",
                   "Standard deviation of the external torque of each joint apart from friction "
                   "and model_error; absent: 0.1 of each",
                   {1e-6, 1000}, kAny, &JointLists::deviation)
          .optional());
  constexpr double kDeviation = 0.1;  // N m
  options.deviation = to_joints(node, "joint_deviation", lists.deviation, joints, kDeviation);
  options.X_ES = context.frames.X_ES;
  try {
    const kinematics::ChainDynamics dynamics(arm.chain, read_links(node, arm, options.X_ES),
                                             context.frames.gravity_W);
    return std::make_unique<JointTorque>(dynamics, options);
  } catch (const std::invalid_argument& error) {
    node.fail("component", error.what());
  }
}

}  // namespace palpate::registry
