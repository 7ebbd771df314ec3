#include "core/control/dual_quaternion.hpp"

#include <cstring>
#include <stdexcept>

#include "core/math/dual_quaternion.hpp"

namespace palpate::control {
namespace {

math::DualQuaternion from_value(const Eigen::VectorXd& pose) {
  const math::Pose X = math::make_pose(math::rotation_from_wxyz(pose.data() + 3), pose.head<3>());
  return math::DualQuaternion::from_pose(X);
}

}  // namespace

void DualQuaternion::configure_for(const shape::Feature& feature) {
  if (std::strcmp(feature.kind(), "pose") != 0) {
    throw std::invalid_argument("the law dual_quaternion steers pose features only");
  }
  TwistLaw::configure_for(feature);
}

void DualQuaternion::motion_to_target(const LawInputs& inputs, Eigen::VectorXd& motion) noexcept {
  const math::DualQuaternion error =
      from_value(*inputs.value) * from_value(*inputs.target).conjugate();
  // about the origin of O, whereas the feature's velocity refers to its own origin
  const math::Twist from_target =
      math::move_reference(error.log().twist(), inputs.value->head<3>());
  motion.head<3>() = -from_target.linear;
  motion.tail<3>() = -from_target.angular;
}

}  // namespace palpate::control
