#pragma once

#include "core/control/control_law.hpp"
#include "core/shape/feature.hpp"

namespace palpate::control {

/// J = sum over the support of (d feature / d x_i) (d x_i / d xi). `node_motion(node)` returns the
/// 3 x 6 block d x_i / d xi. Costs six products per entry of the feature's own Jacobian. Does not
/// allocate.
template <class NodeMotion>
void accumulate_support(const shape::Feature& feature, const NodeMotion& node_motion,
                        Eigen::Ref<Eigen::MatrixXd> J) noexcept {
  J.setZero();
  const Eigen::SparseMatrix<double>& H = feature.jacobian();
  const std::vector<int>& support = feature.support();
  for (int i = 0; i < static_cast<int>(support.size()); ++i) {
    const Eigen::Matrix<double, 3, 6> block = node_motion(support[i]);
    for (int k = 0; k < 3; ++k) {
      for (Eigen::SparseMatrix<double>::InnerIterator entry(H, 3 * i + k); entry; ++entry) {
        J.row(entry.row()) += entry.value() * block.row(k);
      }
    }
  }
}

/// J = H dx/dxi: derivative of the feature with respect to the nodes times the deformation model's
/// static sensitivity of the nodes to the motion of the held grasp.
class FemJacobian : public JacobianProvider {
 public:
  struct Options {
    int grasp = 0;      // index of the moving grasp
    bool both = false;  // both grasps move: twelve columns
  };

  /// Throws std::invalid_argument if `grasp` is neither 0 nor 1.
  explicit FemJacobian(const Options& options);

  /// False while the model has no sensitivity or a moving grasp is not held.
  bool update(const shape::Feature& feature, const elasticity::DeformationModel& model,
              const math::Pose& X_OG, Eigen::Ref<Eigen::MatrixXd> J) noexcept override;

 private:
  bool fill(int grasp, const shape::Feature& feature, const elasticity::DeformationModel& model,
            Eigen::Ref<Eigen::MatrixXd> J) const noexcept;

  Options options_;
};

/// Jacobian of a feature assumed to move rigidly with G: node i moves by [I, -[x_i - p_OG]x]. For a
/// point feature J = [I, -[r]x] with r from the origin of G to the point, for a pose [I, -[r]x; 0,
/// I]. Baseline without a mechanical model.
class KinematicJacobian : public JacobianProvider {
 public:
  bool update(const shape::Feature& feature, const elasticity::DeformationModel& model,
              const math::Pose& X_OG, Eigen::Ref<Eigen::MatrixXd> J) noexcept override;
};

}  // namespace palpate::control
