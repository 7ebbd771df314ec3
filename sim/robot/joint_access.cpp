#include "sim/robot/joint_access.hpp"

#include <stdexcept>

namespace palpate::robot {

void set_at_rest(const Joints& joints, const JointLimits& limits, const Eigen::VectorXd& q) {
  const int count = static_cast<int>(joints.size());
  if (q.size() != count)
    throw std::invalid_argument("there are " + std::to_string(count) + " joints, not " +
                                std::to_string(q.size()));
  for (int i = 0; i < count; ++i)
    if (!(q(i) >= limits.lower(i) && q(i) <= limits.upper(i)))
      throw std::invalid_argument("joint " + std::to_string(i) + " (" + joints[i]->getName() +
                                  ") is beyond its limits");
  for (int i = 0; i < count; ++i) {
    joints[i]->setPosition(q(i));
    joints[i]->setVelocity(0);
    joints[i]->setAcceleration(0);
  }
}

}  // namespace palpate::robot
