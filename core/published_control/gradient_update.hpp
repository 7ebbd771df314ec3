#pragma once

#include "core/published_control/jacobian_update.hpp"

namespace palpate::published_control {

/// Navarro-Alarcon, Yip, Wang, Liu, Zhong, Zhang and Li, "Automatic 3-D manipulation of soft
/// objects by robotic arms with an adaptive deformation model", IEEE Trans. Robotics 32(2), 2016:
/// row [46]; and, on the images of two cameras (see TwoCameraView), the estimator of row [45].
///
/// Consumes: 3-D points (vision), the hand's pose, six probes. Kept: an elastic model that is
/// linear in its unknown parameters (here the entries of J), adapted along the gradient of the
/// squared error of prediction,
///   J += gain (ds - J dr) dr^T / (rho^2 + dr^T dr),
/// rho keeping small motions from mattering, as a gradient flow does where Broyden's rule does not.
/// Left out: the force-based parametrisation, the adaptation driven by the task's own error (which
/// their proof of passivity wants), and the saturated law. Written from the papers' summaries.
class GradientUpdate final : public JacobianUpdate {
 public:
  struct Options {
    double gain = 0.3;       // (0, 2)
    double softness = 2e-3;  // rho, m, >= 0
  };
  /// Throws std::invalid_argument where an option is out of range.
  explicit GradientUpdate(const Options& options);
  void resize(int rows) override { residual_.setZero(rows); }
  void learn(const ScaledMotion& motion, const Eigen::VectorXd& change, bool probe,
             Eigen::MatrixXd& J) noexcept override;

 private:
  Options options_;
  Eigen::VectorXd residual_;
};

}  // namespace palpate::published_control
