#pragma once

#include <memory>

#include "core/published_control/feature_view.hpp"
#include "core/published_control/jacobian_update.hpp"
#include "core/published_control/probes.hpp"

namespace palpate::published_control {

struct LearningOptions {
  ProbeOptions probes;
  double period = 1.0 / 30;    // s between two motions that are learnt from, at least
  double least_motion = 1e-3;  // m, of a ScaledMotion that is learnt from: the dead zone
  double length = 0.1;         // m, by which rotations are scaled
};

/// What all model-free methods have in common: six probes for a first Jacobian, then a law steers
/// and the Jacobian is updated by what the hand's motions have done to the feature. The time that
/// probes take is the method's own. Learns from new looks at the feature alone.
class LearningJacobian final : public control::JacobianProvider {
 public:
  /// Throws std::invalid_argument where an option is out of range or the feature cannot be learnt.
  LearningJacobian(const LearningOptions& options, std::unique_ptr<FeatureView> view,
                   std::unique_ptr<JacobianUpdate> update, const shape::Feature& feature);

  void observe(const control::Experience& now) noexcept override;
  bool update(const shape::Feature& feature, const elasticity::DeformationModel& model,
              const math::Pose& X_OG, Eigen::Ref<Eigen::MatrixXd> J) noexcept override;
  bool commands(const control::LawInputs& inputs, math::Twist& V_O_G) noexcept override;
  void reset() noexcept override;

  const Eigen::MatrixXd& scaled_jacobian() const noexcept { return J_; }  // of what is seen

 private:
  ScaledMotion motion_since(const math::Pose& X_OG) const noexcept;
  void take_probe(const math::Pose& X_OG) noexcept;

  LearningOptions options_;
  std::unique_ptr<FeatureView> view_;
  std::unique_ptr<JacobianUpdate> update_;
  Probes probes_;
  Eigen::MatrixXd J_, J_seen_;     // by ScaledMotion; by (m, rad)
  Eigen::MatrixXd probe_changes_;  // rows x 6
  math::Matrix6d probe_motions_;   // by column
  Eigen::VectorXd seen_, last_, change_;
  math::Pose X_last_ = math::Pose::Identity();
  double since_ = 0;  // s
  bool begun_ = false, known_ = false;
};

}  // namespace palpate::published_control
