#pragma once

#include <memory>

#include "tools/lab/baselines/control/feature_view.hpp"
#include "tools/lab/baselines/control/jacobian_update.hpp"
#include "tools/lab/baselines/control/probes.hpp"

namespace palpate::baselines {

struct LearningOptions {
  ProbeOptions probes;
  double period = 1.0 / 30;    // s, minimum interval between two motions used for learning
  double least_motion = 1e-3;  // m, dead zone: minimum ScaledMotion used for learning
  double length = 0.1;         // m, length that scales rotations
};

/// Common part of all model-free methods: six probing motions provide an initial Jacobian, then a
/// law controls the hand and the Jacobian is updated from motions of the hand and the resulting
/// changes of the feature. The time of the probing motions counts for the method. Learns from new
/// observations of the feature only.
class LearningJacobian final : public control::JacobianProvider {
 public:
  /// Throws std::invalid_argument if an option is out of range or the feature is not supported.
  LearningJacobian(const LearningOptions& options, std::unique_ptr<FeatureView> view,
                   std::unique_ptr<JacobianUpdate> update, const shape::Feature& feature);

  void observe(const control::Experience& now) noexcept override;
  bool update(const shape::Feature& feature, const elasticity::DeformationModel& model,
              const math::Pose& X_OG, Eigen::Ref<Eigen::MatrixXd> J) noexcept override;
  bool commands(const control::LawInputs& inputs, math::Twist& V_O_G) noexcept override;
  void reset() noexcept override;

  // Jacobian of the representation
  const Eigen::MatrixXd& scaled_jacobian() const noexcept { return J_; }

 private:
  ScaledMotion motion_since(const math::Pose& X_OG) const noexcept;
  void take_probe(const math::Pose& X_OG) noexcept;

  LearningOptions options_;
  std::unique_ptr<FeatureView> view_;
  std::unique_ptr<JacobianUpdate> update_;
  Probes probes_;
  Eigen::MatrixXd J_, J_seen_;     // with respect to ScaledMotion; with respect to (m, rad)
  Eigen::MatrixXd probe_changes_;  // rows x 6
  math::Matrix6d probe_motions_;   // by column
  Eigen::VectorXd seen_, last_, change_;
  math::Pose X_last_ = math::Pose::Identity();
  double since_ = 0;  // s
  bool begun_ = false, known_ = false;
};

}  // namespace palpate::baselines
