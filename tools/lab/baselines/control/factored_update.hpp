#pragma once

#include "tools/lab/baselines/control/jacobian_update.hpp"

namespace palpate::baselines {

/// Alambeigi, Wang, Hegeman, Liu and Armand, "A robust data-driven approach for online learning and
/// manipulation of unmodeled 3-D heterogeneous compliant objects", IEEE Robotics and Automation
/// Letters 3(4), 2018: row [54] of Table 2.2 in Sanchez 2019.
///
/// Consumes: image features (vision, see TwoCameraView), pose of the hand, six probing motions; no
/// model. Kept: the Jacobian is a product of two unknown ones, of the image with respect to the
/// deformation and of the deformation with respect to the hand, J = A B, both learnt online as the
/// object changes: each by the minimum-norm rank-one update for a given other factor, with half of
/// the remaining prediction error. Left out: the constrained least squares by which the paper
/// estimates both, and their continuum robot.
class FactoredUpdate final : public JacobianUpdate {
 public:
  /// Throws std::invalid_argument if gain is not in (0, 1].
  explicit FactoredUpdate(double gain);
  void resize(int rows) override;
  void forget() noexcept override { split_ = false; }
  void learn(const ScaledMotion& motion, const Eigen::VectorXd& change, bool probe,
             Eigen::MatrixXd& J) noexcept override;

 private:
  void split(const Eigen::MatrixXd& J) noexcept;

  double gain_;
  Eigen::MatrixXd image_;       // A, rows x 6
  math::Matrix6d deformation_;  // B
  Eigen::VectorXd residual_, step_;
  bool split_ = false;
};

}  // namespace palpate::baselines
