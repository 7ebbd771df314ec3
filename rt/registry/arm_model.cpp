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

/// Joint limits of the section replace those of the file, for all joints at once.
void read_ends(const config::Node& node, const std::string& key, SerialChain::Joints& ends) {
  if (!node.has(key)) return;
  const std::vector<double> degrees =
      node.numbers({key, "degrees", "Position limits of the joints, in place of those of the URDF"},
                   static_cast<int>(ends.size()), {-3.6e5, 3.6e5});
  for (int i = 0; i < ends.size(); ++i) ends[i] = degrees[i] * kDegree;
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
    auto model = std::make_shared<ArmModel>(ArmModel{read_urdf(urdf, flange), {}});
    const SerialChain& chain = model->chain;
    const int n = chain.joint_count();
    control::JointLimits& limits = model->limits;
    limits.lower.resize(n);
    limits.upper.resize(n);
    limits.speed.resize(n);
    for (int i = 0; i < n; ++i) {
      limits.lower[i] = chain.joint(i).lower;
      limits.upper[i] = chain.joint(i).upper;
      limits.speed[i] = chain.joint(i).speed;
    }
    read_ends(node, "joint_lower_deg", limits.lower);
    read_ends(node, "joint_upper_deg", limits.upper);
    const double margin = node.number({"joint_margin_deg", "degrees",
                                       "Margin from both position limits of every joint"},
                                      {0, 90}, 1) *
                          kDegree;
    limits.lower.array() += margin;
    limits.upper.array() -= margin;
    limits.speed *= node.number(
        {"joint_speed_share", "", "Fraction of the speed limits in the URDF that is used"},
        {0.01, 1}, 1);
    limits.acceleration = SerialChain::Joints::Constant(
        n, node.number({"joint_acceleration", "rad/s^2", "Largest acceleration of every joint"},
                       {0.01, 1e3}, 5));
    limits.check();
    return model;
  } catch (const std::invalid_argument& error) {
    node.fail("urdf", error.what());
  }
}

}  // namespace palpate::registry
