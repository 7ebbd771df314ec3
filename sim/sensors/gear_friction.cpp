#include "sim/sensors/gear_friction.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

namespace palpate::sensors {
namespace {

Eigen::VectorXd per_joint(const std::vector<double>& values, int count, const char* name) {
  if (values.empty()) return Eigen::VectorXd::Zero(count);
  if (static_cast<int>(values.size()) != count)
    throw std::invalid_argument("sensors.robot_state.friction." + std::string(name) + ": " +
                                std::to_string(values.size()) +
                                " values; allowed: " + std::to_string(count) + ", one per joint");
  return Eigen::Map<const Eigen::VectorXd>(values.data(), count);
}

}  // namespace

FrictionTorque::FrictionTorque(const GearFriction& friction, int joint_count)
    : coulomb_(per_joint(friction.coulomb, joint_count, "coulomb")),
      viscous_(per_joint(friction.viscous, joint_count, "viscous")),
      share_(Eigen::VectorXd::Zero(joint_count)),
      torque_(Eigen::VectorXd::Zero(joint_count)),
      presliding_(friction.presliding) {}

const Eigen::VectorXd& FrictionTorque::at(const Eigen::VectorXd& q, const Eigen::VectorXd& dq) {
  if (q_.size() == 0) q_ = q;
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    // exact for a motion in one direction between two calls
    const double moved = q(i) - q_(i), end = moved < 0 ? -1 : 1;
    share_(i) = end + (share_(i) - end) * std::exp(-std::abs(moved) / presliding_);
    torque_(i) = coulomb_(i) * share_(i) + viscous_(i) * dq(i);
  }
  q_ = q;
  return torque_;
}

}  // namespace palpate::sensors
