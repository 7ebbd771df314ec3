#include "core/kinematics/chain_dynamics.hpp"

#include "core/math/option_check.hpp"

namespace palpate::kinematics {
namespace {

/// Integral of r . s I - (r s^T + s r^T) / 2 over a body with r = s: the inertia of point masses.
Eigen::Matrix3d product(const Eigen::Vector3d& r, const Eigen::Vector3d& s) noexcept {
  return r.dot(s) * Eigen::Matrix3d::Identity() - 0.5 * (r * s.transpose() + s * r.transpose());
}

}  // namespace

BodyInertia BodyInertia::moved(const math::Pose& X_AB, const BodyInertia& of_B) noexcept {
  const Eigen::Matrix3d& R = X_AB.linear();
  const Eigen::Vector3d p = X_AB.translation(), turned = R * of_B.first_moment;
  BodyInertia in_A;
  in_A.mass = of_B.mass;
  in_A.first_moment = turned + of_B.mass * p;
  in_A.rotational =
      R * of_B.rotational * R.transpose() + of_B.mass * product(p, p) + 2 * product(p, turned);
  return in_A;
}

BodyInertia& BodyInertia::operator+=(const BodyInertia& other) noexcept {
  mass += other.mass;
  first_moment += other.first_moment;
  rotational += other.rotational;
  return *this;
}

ChainDynamics::ChainDynamics(SerialChain chain, std::vector<BodyInertia> links,
                             const Eigen::Vector3d& gravity_W)
    : chain_(std::move(chain)), links_(std::move(links)), gravity_W_(gravity_W) {
  math::check_option(static_cast<int>(links_.size()) == chain_.joint_count(), "links",
                     links_.size(), "one per joint, " + std::to_string(chain_.joint_count()));
  for (int i = 0; i < chain_.joint_count(); ++i) {
    const std::string name = "link beyond " + chain_.joint(i).name + ": ";
    const BodyInertia& link = links_[i];
    math::check_not_negative(link.mass, name + "mass");
    math::check_all_finite(link.first_moment, name + "first moment");
    math::check_all_finite(link.rotational, name + "inertia");
  }
  math::check_all_finite(gravity_W_, "gravity");
}

void ChainDynamics::evaluate(const Eigen::Ref<const Eigen::VectorXd>& q,
                             const Eigen::Ref<const Eigen::VectorXd>& dq,
                             State& state) const noexcept {
  const int n = chain_.joint_count();
  SerialChain::Frames X_WJ;
  chain_.locate(q, X_WJ);
  // Of each joint or link, about the origin of W, in W; twists with the velocity of the body's
  // point at that origin.
  std::array<math::Twist, SerialChain::kMostJoints> axis, axis_rate;
  std::array<math::Wrench, SerialChain::kMostJoints> momentum;  // N s, N m s
  std::array<BodyInertia, SerialChain::kMostJoints> body;
  math::Twist V;
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector3d along = X_WJ[i].linear() * chain_.joint(i).axis_J;
    axis[i] = chain_.joint(i).revolute ? math::Twist{X_WJ[i].translation().cross(along), along}
                                       : math::Twist{along, Eigen::Vector3d::Zero()};
    axis_rate[i] = {V.angular.cross(axis[i].linear) + V.linear.cross(axis[i].angular),
                    V.angular.cross(axis[i].angular)};
    V.linear += dq[i] * axis[i].linear;
    V.angular += dq[i] * axis[i].angular;
    body[i] = BodyInertia::moved(X_WJ[i], links_[i]);
    momentum[i] = {body[i].mass * V.linear + V.angular.cross(body[i].first_moment),
                   body[i].rotational * V.angular + body[i].first_moment.cross(V.linear)};
  }
  for (Joints* joints : {&state.momentum, &state.coriolis, &state.gravity}) joints->resize(n);
  math::Wrench beyond;  // momentum of everything beyond joint i
  double mass = 0;
  Eigen::Vector3d first_moment = Eigen::Vector3d::Zero();
  for (int i = n - 1; i >= 0; --i) {
    beyond.force += momentum[i].force;
    beyond.torque += momentum[i].torque;
    mass += body[i].mass;
    first_moment += body[i].first_moment;
    const auto by = [](const math::Twist& S, const math::Wrench& F) {
      return S.linear.dot(F.force) + S.angular.dot(F.torque);
    };
    state.momentum[i] = by(axis[i], beyond);
    state.coriolis[i] = by(axis_rate[i], beyond);
    state.gravity[i] = -by(axis[i], {mass * gravity_W_, first_moment.cross(gravity_W_)});
  }
}

}  // namespace palpate::kinematics
