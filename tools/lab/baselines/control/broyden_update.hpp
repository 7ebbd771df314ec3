#pragma once

#include "tools/lab/baselines/control/jacobian_update.hpp"

namespace palpate::baselines {

/// Navarro-Alarcon, Liu, Romero and Li, "Model-free visually servoed deformation control of elastic
/// objects by robot manipulators", IEEE Trans. Robotics 29(6), 2013: row [44] of Table 2.2 in
/// Sanchez 2019.
///
/// Consumes: feature values (vision), pose of the hand, six probing motions; no model and no
/// parameters of the object. Kept: features as functions of points; Broyden's rank-one update J +=
/// gain (ds - J dr) dr^T / (dr^T dr), a dead zone on |dr|, initial Jacobian from test motions. Left
/// out: the 2-D image (points are 3-D), the saturated law with its energy-shaping proof; the law is
/// the one common to all baselines.
class BroydenUpdate final : public JacobianUpdate {
 public:
  /// Throws std::invalid_argument if gain is not in (0, 1].
  explicit BroydenUpdate(double gain);
  void resize(int rows) override { residual_.setZero(rows); }
  void learn(const ScaledMotion& motion, const Eigen::VectorXd& change, bool probe,
             Eigen::MatrixXd& J) noexcept override;

 private:
  double gain_;
  Eigen::VectorXd residual_;
};

}  // namespace palpate::baselines
