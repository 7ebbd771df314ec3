#pragma once

#include <array>
#include <vector>

#include "core/control/joint_limits.hpp"
#include "core/elasticity/deformation_model.hpp"
#include "core/shape/feature.hpp"

namespace palpate::control {

/// What a provider that learns may look at.
struct Experience {
  double dt = 1e-3;                             // s
  const Eigen::VectorXd* value = nullptr;       // of the feature, as it is seen or estimated
  const Eigen::Matrix3Xd* positions = nullptr;  // of the nodes that it was evaluated on
  bool fresh = true;                            // something new has been seen since the last tick
  math::Pose X_OG = math::Pose::Identity();     // of the hand that moves
  bool wrench_valid = false;
  math::Wrench F_G_O;  // of that hand on the object at the origin of G, in O, as measured
};

struct LawInputs {
  double dt = 1e-3;
  const Eigen::VectorXd* value = nullptr;  // value_count() long
  const Eigen::VectorXd* target = nullptr;
  const Eigen::VectorXd* error = nullptr;  // dimension() long
  const Eigen::MatrixXd* jacobian = nullptr;
  // What limits speak of; without a model none of them is kept.
  const elasticity::DeformationModel* model = nullptr;
  std::array<math::Pose, 2> X_OG{math::Pose::Identity(), math::Pose::Identity()};
  std::array<math::Wrench, 2> reaction{};  // of the hand on the object at G, in O, as estimated
  const JointInputs* joints = nullptr;     // where the law is to command joints
  /// Of each node of the model, m, as Estimate has it; nullptr: not estimated.
  const std::vector<float>* node_deviation = nullptr;
};

/// How the feature follows the motion of grasp G: d feature = J d xi with xi = (displacement of the
/// origin of G, rotation about it), both in O. J: feature dimension x 6, preallocated; x 12 where
/// two grasps move, the first one's columns first.
class JacobianProvider {
 public:
  virtual ~JacobianProvider() = default;

  /// Once a tick, before update().
  virtual void observe(const Experience& /*now*/) noexcept {}
  /// False where no Jacobian is available yet.
  virtual bool update(const shape::Feature& feature, const elasticity::DeformationModel& model,
                      const math::Pose& X_OG, Eigen::Ref<Eigen::MatrixXd> J) noexcept = 0;

  /// True where the provider itself moves the hand in this tick, as V_O_G says: by a probe, or a
  /// plan. The law is not asked then. After update(), which may have been false for a probe's sake.
  virtual bool commands(const LawInputs& /*inputs*/, math::Twist& /*V_O_G*/) noexcept {
    return false;
  }
  virtual void reset() noexcept {}
};

struct LawOutput {
  math::Twist V_O_G;         // twist of the origin of G, in O
  math::Twist V_O_G_second;  // the same of the second grasp, where two move; else zero
  /// What moves the hand so, of a law that commands joints; else empty.
  kinematics::SerialChain::Joints joint_velocity;
  Eigen::VectorXd unreachable;  // dimension() long, preallocated by the caller
  const char* remark = "";      // what keeps the law from doing as it would; a literal
};

class ControlLaw {
 public:
  virtual ~ControlLaw() = default;
  /// Throws std::invalid_argument where the law cannot steer such a feature. Allocates.
  virtual void configure_for(const shape::Feature& feature) = 0;
  virtual void compute(const LawInputs& inputs, LawOutput& output) noexcept = 0;
  virtual void reset() noexcept {}
};

}  // namespace palpate::control
