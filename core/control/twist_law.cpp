#include "core/control/twist_law.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/math/constants.hpp"
#include "core/math/dual_quaternion.hpp"
#include "core/math/option_check.hpp"

namespace palpate::control {
namespace {

math::DualQuaternion from_value(const Eigen::VectorXd& pose) {
  const math::Pose X = math::make_pose(math::rotation_from_wxyz(pose.data() + 3), pose.head<3>());
  return math::DualQuaternion::from_pose(X);
}

}  // namespace

TwistLawOptions TwistLawOptions::thesis() noexcept {
  TwistLawOptions options;
  options.gain = 0.25;
  options.linear_speed = 1.0;
  options.angular_speed = 0.5;
  options.dead_band.position = 5e-3;
  options.dead_band.angle = math::kDegree;
  return options;
}

TwistLaw::TwistLaw(const Options& options)
    : options_(options), inverse_(options.inverse), dead_band_(options.dead_band) {
  const auto check = [](double value, double least, const char* name) {
    const std::string allowed = "at least " + std::to_string(least) + ", below 1e6";
    math::check_option(value >= least && value < 1e6, name, value, allowed);
  };
  check(options.gain, 1e-6, "gain");
  check(options.linear_speed, 1e-6, "linear_speed");
  check(options.angular_speed, 1e-6, "angular_speed");
  check(options.dead_band.position, 0, "dead_band.position");
  check(options.dead_band.angle, 0, "dead_band.angle");
  check(options.dead_band.release, 1, "dead_band.release");
}

void TwistLaw::configure_for(const shape::Feature& feature) {
  inverse_.set_up(feature);
  motion_.setZero(feature.dimension());
  position_rows_ = inverse_.row_scale();
  angle_rows_.setZero(feature.dimension());
  for (int row = 0; row < feature.dimension(); ++row) {
    if (feature.unit(row) != shape::Unit::kRadian) continue;
    position_rows_[row] = 0;
    angle_rows_[row] = 1;
  }
  const double points = (feature.dimension() - angle_rows_.sum()) / 3;
  point_scale_ = 1 / std::sqrt(std::max(1.0, points));
  dead_band_.reset();
}

PseudoInverse::Motion TwistLaw::solve(const LawInputs&, const Eigen::VectorXd& motion,
                                      LawOutput&) noexcept {
  return inverse_.solve(motion);
}

void TwistLaw::compute(const LawInputs& inputs, LawOutput& output) noexcept {
  output.V_O_G = output.V_O_G_second = math::Twist();
  output.joint_velocity.setZero();
  output.remark = "";
  const Eigen::VectorXd& error = *inputs.error;
  if (!error.allFinite()) {
    output.unreachable.setZero();
    return rest();
  }
  if (!inverse_.decompose(*inputs.jacobian)) {
    output.unreachable = error;
    return rest();
  }
  inverse_.unreachable(error, output.unreachable);
  motion_ = error - output.unreachable;
  if (rests(motion_)) return rest();

  motion_to_target(inputs, motion_);
  if (!motion_.allFinite()) return rest();
  motion_ *= options_.gain;
  const PseudoInverse::Motion u = solve(inputs, motion_, output);
  math::Twist first = math::Twist::from(u.head<6>()), second;
  if (options_.inverse.grasps == 2) second = math::Twist::from(u.tail<6>());
  // One factor for both hands, so that their relative motion is kept.
  const double factor =
      std::min(speed_factor(first, options_.linear_speed, options_.angular_speed),
               speed_factor(second, options_.linear_speed, options_.angular_speed));
  output.V_O_G = {factor * first.linear, factor * first.angular};
  output.V_O_G_second = {factor * second.linear, factor * second.angular};
}

bool TwistLaw::rests(const Eigen::VectorXd& reachable) noexcept {
  const double position = point_scale_ * reachable.cwiseProduct(position_rows_).norm();
  const double angle = reachable.cwiseProduct(angle_rows_).norm();
  return dead_band_.rests(position, angle);
}

void DualQuaternion::configure_for(const shape::Feature& feature) {
  math::check_option(std::strcmp(feature.kind(), "pose") == 0, "feature", feature.kind(), "pose");
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
