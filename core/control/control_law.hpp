#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "core/collision/obstacle.hpp"
#include "core/elasticity/deformation_model.hpp"
#include "core/kinematics/serial_chain.hpp"
#include "core/math/rigid.hpp"
#include "core/shape/feature.hpp"

namespace palpate::control {

/// Limits of a hand: of the motion of one of its frames and of its wrench.
struct HandLimits {
  double linear_speed = 1.0;                          // m/s, of the frame's origin
  double angular_speed = 0.5;                         // rad/s
  double linear_acceleration = 0.5;                   // m/s^2
  double angular_acceleration = 2.0;                  // rad/s^2
  double force = 1e3;                                 // N
  double torque = 1e3;                                // N m
  Eigen::Vector3d workspace_lower{-1e3, -1e3, -1e3};  // m, of the frame's origin
  Eigen::Vector3d workspace_upper{1e3, 1e3, 1e3};

  /// Throws std::invalid_argument, with `prefix` before the name, if a limit is not above 0 and
  /// below `bound` or the workspace is empty.
  void check(const std::string& prefix, double bound) const;
};

/// Motion limits of the joints of an arm, one entry per joint; rad, s (m for prismatic joints).
struct JointLimits {
  kinematics::SerialChain::Joints lower, upper;  // position limits
  kinematics::SerialChain::Joints speed, acceleration;

  int count() const noexcept { return static_cast<int>(speed.size()); }
  bool empty() const noexcept { return count() == 0; }
  /// Throws std::invalid_argument if sizes differ, a range is empty or a limit is not positive.
  void check() const;
};

/// Present state of the joints of the arm that holds the grasp.
struct JointInputs {
  kinematics::SerialChain::Joints q;
  /// Jacobian of the twist of the origin of G, in O
  kinematics::SerialChain::Jacobian V_O_G_by_joints;
};

/// Inputs of a Jacobian provider that learns from motion.
struct Experience {
  double dt = 1e-3;                             // s
  const Eigen::VectorXd* value = nullptr;       // value of the feature, observed or estimated
  const Eigen::Matrix3Xd* positions = nullptr;  // node positions that the feature was evaluated on
  bool fresh = true;                            // a new observation has arrived since the last tick
  math::Pose X_OG = math::Pose::Identity();     // pose of the moving hand
  bool wrench_valid = false;
  math::Wrench F_G_O;  // measured wrench of that hand on the object at the origin of G, in O
};

struct LawInputs {
  double dt = 1e-3;
  const Eigen::VectorXd* value = nullptr;  // length value_count()
  const Eigen::VectorXd* target = nullptr;
  const Eigen::VectorXd* error = nullptr;  // length dimension()
  const Eigen::MatrixXd* jacobian = nullptr;
  // Model used by the limits on the object; without a model these limits are inactive.
  const elasticity::DeformationModel* model = nullptr;
  std::array<math::Pose, 2> X_OG{math::Pose::Identity(), math::Pose::Identity()};
  std::array<math::Wrench, 2> reaction{};  // estimated wrench of the hand on the object at G, in O
  const JointInputs* joints = nullptr;     // set if the law commands joints
  /// Where the obstacles of the configuration are, in its order; nullptr: as configured.
  const std::vector<collision::Placement>* obstacles = nullptr;
  /// Standard deviation of each node position of the model, m, as in Estimate; nullptr: not
  /// estimated.
  const std::vector<float>* node_deviation = nullptr;
};

/// Derivative of the feature with respect to the motion of grasp G: d feature = J d xi with xi =
/// (displacement of the origin of G, rotation about it), both in O. J: feature dimension x 6,
/// preallocated; x 12 if two grasps move, the first one's columns first.
class JacobianProvider {
 public:
  virtual ~JacobianProvider() = default;

  /// Called once per tick, before update().
  virtual void observe(const Experience& /*now*/) noexcept {}
  /// False if no Jacobian is available yet.
  virtual bool update(const shape::Feature& feature, const elasticity::DeformationModel& model,
                      const math::Pose& X_OG, Eigen::Ref<Eigen::MatrixXd> J) noexcept = 0;

  /// True if the provider itself moves the hand in this tick, with twist V_O_G, for a probing
  /// motion or along a plan; the law is then not evaluated. Called after update(), which may have
  /// returned false because of a probe.
  virtual bool commands(const LawInputs& /*inputs*/, math::Twist& /*V_O_G*/) noexcept {
    return false;
  }
  virtual void reset() noexcept {}
};

struct LawOutput {
  math::Twist V_O_G;         // twist of the origin of G, in O
  math::Twist V_O_G_second;  // the same for the second grasp, if two move; else zero
  /// Joint velocities that produce the twist, if the law commands joints; else empty.
  kinematics::SerialChain::Joints joint_velocity;
  Eigen::VectorXd unreachable;  // length dimension(), preallocated by the caller
  const char* remark = "";      // limitation that is active in this tick; a string literal
};

class ControlLaw {
 public:
  virtual ~ControlLaw() = default;
  /// Throws std::invalid_argument if the law does not support such a feature. Allocates.
  virtual void configure_for(const shape::Feature& feature) = 0;
  virtual void compute(const LawInputs& inputs, LawOutput& output) noexcept = 0;
  virtual void reset() noexcept {}
};

/// limit / |v| if |v| > limit, else 1; also exact if the squares overflow.
inline double factor_to_limit(const Eigen::Vector3d& v, double limit) noexcept {
  const double largest = v.cwiseAbs().maxCoeff();
  if (!(largest > 0)) return 1;
  return std::min(1.0, limit / largest / (v / largest).norm());
}

/// Largest factor up to 1 by which the twist satisfies both limits.
inline double speed_factor(const math::Twist& V, double linear, double angular) noexcept {
  return std::min(factor_to_limit(V.linear, linear), factor_to_limit(V.angular, angular));
}

/// Scales the whole twist until both speeds satisfy their limits; the screw axis is unchanged.
inline math::Twist limit_speed(const math::Twist& V, double linear, double angular) noexcept {
  const double factor = speed_factor(V, linear, angular);
  return {factor * V.linear, factor * V.angular};
}

/// Maximum speed, m/s (rad/s), towards a wall at `distance` from which braking with `deceleration`
/// from the next step on still stops before it: v dt + v^2 / 2a = distance.
inline double approach_speed(double distance, double deceleration, double dt) noexcept {
  if (!(distance > 0)) return 0;
  const double step = deceleration * dt;
  return std::sqrt(step * step + 2 * deceleration * distance) - step;
}

}  // namespace palpate::control
