#include "rt/registry/arm_model.hpp"

#include <algorithm>
#include <stdexcept>

#include "core/math/constants.hpp"
#include "rt/registry/urdf_file.hpp"

namespace palpate::registry {
namespace {

using kinematics::SerialChain;
using math::kDegree;
constexpr double kTurn = 2 * math::kPi;

kinematics::Joint to_joint(const urdf::Joint& from) {
  const bool turns_on = from.type == urdf::Joint::CONTINUOUS;
  if (from.type != urdf::Joint::REVOLUTE && from.type != urdf::Joint::PRISMATIC && !turns_on)
    throw std::invalid_argument("joint " + from.name +
                                ": is neither revolute, continuous nor prismatic");
  if (!from.limits) throw std::invalid_argument("joint " + from.name + ": has no limits");
  kinematics::Joint joint;
  joint.name = from.name;
  joint.revolute = from.type != urdf::Joint::PRISMATIC;
  const Eigen::Vector3d axis(from.axis.x, from.axis.y, from.axis.z);
  if (!(axis.norm() > 1e-6)) throw std::invalid_argument("joint " + from.name + ": has no axis");
  joint.axis_J = axis.normalized();
  joint.lower = turns_on ? -1e3 * kTurn : from.limits->lower;
  joint.upper = turns_on ? 1e3 * kTurn : from.limits->upper;
  joint.speed = from.limits->velocity;
  return joint;
}

/// Limits of the section `robot`; empty lists: those of the URDF.
struct JointOptions {
  std::vector<double> lower, upper;  // degrees
  double margin = kDegree;           // rad
  double speed_share = 1;
  double acceleration = 5;  // rad/s^2
};

config::OptionTable<JointOptions> joint_options(int count) {
  constexpr const char* kEnds = "Position limits of the joints, in place of those of the URDF";
  constexpr config::Range kDegrees{-3.6e5, 3.6e5};
  return config::OptionTable<JointOptions>()
      .numbers("joint_lower_deg", "degrees", kEnds, kDegrees, count, &JointOptions::lower)
      .optional()
      .numbers("joint_upper_deg", "degrees", kEnds, kDegrees, count, &JointOptions::upper)
      .optional()
      .number("joint_margin_deg", "degrees", "Margin from both position limits of every joint",
              {0, 90}, &JointOptions::margin, kDegree)
      .number("joint_speed_share", "", "Fraction of the speed limits in the URDF that is used",
              {0.01, 1}, &JointOptions::speed_share)
      .number("joint_acceleration", "rad/s^2", "Largest acceleration of every joint", {0.01, 1e3},
              &JointOptions::acceleration);
}

}  // namespace

SerialChain read_urdf(const std::string& path, const std::string& flange) {
  const urdf::ModelInterfaceSharedPtr model = parse_urdf(path);
  urdf::LinkConstSharedPtr link = model->getLink(flange);
  if (!link) throw std::invalid_argument(path + ": has no link '" + flange + "'");
  std::vector<kinematics::Joint> joints;         // from the flange to the base
  math::Pose X_beyond = math::Pose::Identity();  // fixed transform beyond the previous joint
  math::Pose X_JE = math::Pose::Identity();
  try {
    for (; link->parent_joint; link = link->getParent()) {
      const urdf::Joint& joint = *link->parent_joint;
      const math::Pose X = to_pose(joint.parent_to_joint_origin_transform);
      if (joint.type == urdf::Joint::FIXED) {
        X_beyond = X * X_beyond;
        continue;
      }
      (joints.empty() ? X_JE : joints.back().X_PJ) =
          joints.empty() ? X_beyond : math::Pose(X_beyond * joints.back().X_PJ);
      X_beyond = math::Pose::Identity();
      joints.push_back(to_joint(joint));
      joints.back().X_PJ = X;
    }
    if (!joints.empty()) joints.back().X_PJ = X_beyond * joints.back().X_PJ;
    std::reverse(joints.begin(), joints.end());
    return SerialChain(joints, X_JE);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(path + ": " + error.what());
  }
}

std::shared_ptr<const ArmModel> read_arm_model(const config::Node& root) {
  if (root.has("second_arm") && root.child("second_arm").has("robot"))
    root.child("second_arm").fail("robot", "joints are commanded of the first arm only");
  if (!root.has("robot")) return nullptr;
  const config::Node node =
      root.child({"robot", "", "Joint model of the first arm; required to command joints"});
  try {
    const std::string urdf = node.path({"urdf", "", "Expanded URDF file of the arm"});
    const std::string flange = node.text({"flange", "", "Link of the URDF that is E"}, "flange");
    auto model = std::make_shared<ArmModel>(ArmModel{read_urdf(urdf, flange), {}, urdf, flange});
    const SerialChain& chain = model->chain;
    const int n = chain.joint_count();
    const JointOptions options = node.read(joint_options(n));
    control::JointLimits& limits = model->limits;
    for (auto* values : {&limits.lower, &limits.upper, &limits.speed}) values->resize(n);
    for (int i = 0; i < n; ++i) {
      const kinematics::Joint& joint = chain.joint(i);
      limits.lower[i] = options.lower.empty() ? joint.lower : options.lower[i] * kDegree;
      limits.upper[i] = options.upper.empty() ? joint.upper : options.upper[i] * kDegree;
      limits.speed[i] = joint.speed * options.speed_share;
    }
    limits.lower.array() += options.margin;
    limits.upper.array() -= options.margin;
    limits.acceleration = SerialChain::Joints::Constant(n, options.acceleration);
    limits.check();
    return model;
  } catch (const std::invalid_argument& error) {
    node.fail("urdf", error.what());
  }
}

}  // namespace palpate::registry
