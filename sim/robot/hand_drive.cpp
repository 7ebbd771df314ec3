#include "sim/robot/hand_drive.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "sim/robot/joint_access.hpp"

namespace palpate::robot {
namespace dd = dart::dynamics;

HandDrive::HandDrive(Joints joints, const HandOptions& options)
    : joints_(std::move(joints)), options_(options), limits_(limits_of(joints_)) {
  if (!(options.stiffness > 0) || !(options.damping >= 0))
    throw std::invalid_argument("the hand's stiffness must be above zero, its damping not below");
  target_ = reference_ = positions(joints_);
  torque_ = Eigen::VectorXd::Zero(joint_count());
}

void HandDrive::reset(const Eigen::VectorXd& q) {
  set_at_rest(joints_, limits_, q);
  target_ = reference_ = q;
  torque_.setZero();
  rigid_ = true;
  for (dd::DegreeOfFreedom* joint : joints_) joint->getJoint()->setActuatorType(dd::Joint::LOCKED);
}

void HandDrive::command(const Eigen::VectorXd& target) {
  if (target.size() != joint_count() || !target.allFinite())
    throw std::invalid_argument("the hand takes " + std::to_string(joint_count()) +
                                " finite joint targets");
  target_ = target.cwiseMax(limits_.lower).cwiseMin(limits_.upper);
  if (!rigid_) return;
  rigid_ = false;
  for (dd::DegreeOfFreedom* joint : joints_) {
    joint->getJoint()->setActuatorType(dd::Joint::FORCE);
    joint->setSpringStiffness(options_.stiffness);
    joint->setDampingCoefficient(options_.damping);
  }
}

void HandDrive::step(double dt, const Eigen::VectorXd& load) {
  if (rigid_) return;
  for (int i = 0; i < joint_count(); ++i) {
    const double way = limits_.velocity(i) * dt;
    reference_(i) += std::clamp(target_(i) - reference_(i), -way, way);
    const double most = limits_.torque(i), q = joints_[i]->getPosition();
    const double carry = std::clamp(load(joints_[i]->getIndexInSkeleton()), -most, most);
    const double spring =
        std::clamp(options_.stiffness * (reference_(i) - q), -most - carry, most - carry);
    joints_[i]->setRestPosition(q + spring / options_.stiffness);
    joints_[i]->setForce(carry);
    torque_(i) = spring + carry;
  }
}

}  // namespace palpate::robot
