#pragma once

#include <Eigen/Core>
#include <dart/dynamics/DegreeOfFreedom.hpp>
#include <dart/dynamics/Joint.hpp>
#include <vector>

#include "sim/robot/joint_limits.hpp"

// For the few source files that use DART directly; no other header includes this one.
namespace palpate::robot {

using Joints = std::vector<dart::dynamics::DegreeOfFreedom*>;

/// One value per joint.
template <class Get>
Eigen::VectorXd each(const Joints& joints, Get get) {
  Eigen::VectorXd values(joints.size());
  for (std::size_t i = 0; i < joints.size(); ++i) values(i) = get(*joints[i]);
  return values;
}

inline Eigen::VectorXd positions(const Joints& joints) {
  return each(joints, [](const auto& joint) { return joint.getPosition(); });
}

inline Eigen::VectorXd velocities(const Joints& joints) {
  return each(joints, [](const auto& joint) { return joint.getVelocity(); });
}

inline JointLimits limits_of(const Joints& joints) {
  return {each(joints, [](const auto& joint) { return joint.getPositionLowerLimit(); }),
          each(joints, [](const auto& joint) { return joint.getPositionUpperLimit(); }),
          each(joints, [](const auto& joint) { return joint.getVelocityUpperLimit(); }),
          each(joints, [](const auto& joint) { return joint.getForceUpperLimit(); })};
}

/// Sets joint positions `q` (rad) at rest. Throws std::invalid_argument if the number of joints
/// differs or a value is outside the limits.
void set_at_rest(const Joints& joints, const JointLimits& limits, const Eigen::VectorXd& q);

}  // namespace palpate::robot
