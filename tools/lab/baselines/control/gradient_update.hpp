#pragma once

#include "tools/lab/baselines/control/jacobian_update.hpp"

namespace palpate::baselines {

/// Navarro-Alarcon, Yip, Wang, Liu, Zhong, Zhang and Li, "Automatic 3-D manipulation of soft
/// objects by robotic arms with an adaptive deformation model", IEEE Trans. Robotics 32(2), 2016:
/// row [46] of Table 2.2 in Sanchez 2019; and, on the images of two cameras (see TwoCameraView),
/// the estimator of row [45].
///
/// Consumes: 3-D points (vision), pose of the hand, six probing motions. Kept: an elastic model
/// linear in its unknown parameters (here the entries of J), adapted along the gradient of the
/// squared prediction error, J += gain (ds - J dr) dr^T / (rho^2 + dr^T dr); rho suppresses small
/// motions, as a gradient flow does and Broyden's rule does not. Left out: the force-based
/// parametrisation, the adaptation driven by the task error (required by their passivity proof),
/// and the saturated law. Based on summaries of the papers.
class GradientUpdate final : public JacobianUpdate {
 public:
  struct Options {
    double gain = 0.3;       // (0, 2)
    double softness = 2e-3;  // rho, m, >= 0
  };
  /// Throws std::invalid_argument if an option is out of range.
  explicit GradientUpdate(const Options& options);
  void resize(int rows) override { residual_.setZero(rows); }
  void learn(const ScaledMotion& motion, const Eigen::VectorXd& change, bool probe,
             Eigen::MatrixXd& J) noexcept override;

 private:
  Options options_;
  Eigen::VectorXd residual_;
};

}  // namespace palpate::baselines
