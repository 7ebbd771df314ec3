#pragma once

#include <array>
#include <vector>

#include "core/control/joint_limits.hpp"
#include "core/elasticity/deformation_model.hpp"
#include "core/shape/feature.hpp"

namespace palpate::control {

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

}  // namespace palpate::control
