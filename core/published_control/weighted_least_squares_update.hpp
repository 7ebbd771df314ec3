#pragma once

#include <vector>

#include "core/published_control/jacobian_update.hpp"

namespace palpate::published_control {

/// Lagneau, Krupa and Marchal, "Active deformation through visual servoing of soft objects", ICRA
/// 2020: later work beside Table 2.2.
///
/// Consumes: feature values (vision), the hand's pose, six probes. Kept: weighted least squares
/// over a sliding window of motions, the newer ones weighing more; J is changed only along
/// directions in which the window's motions say enough, judged by the eigenvalues of their
/// covariance. Left out: segmentation and tracking of the RGB-D camera, the choice of the number of
/// features.
class WeightedLeastSquaresUpdate final : public JacobianUpdate {
 public:
  struct Options {
    int window = 25;           // motions, 6 to 500
    double forgetting = 0.95;  // weight of a motion by that of the next one, (0, 1]
    double confidence = 0.05;  // least eigenvalue that is trusted, as a share of the largest
  };
  /// Throws std::invalid_argument where an option is out of range.
  explicit WeightedLeastSquaresUpdate(const Options& options);
  void resize(int rows) override;
  void forget() noexcept override { count_ = next_ = 0; }
  void learn(const ScaledMotion& motion, const Eigen::VectorXd& change, bool probe,
             Eigen::MatrixXd& J) noexcept override;

 private:
  Options options_;
  Eigen::MatrixXd motions_;  // 6 x window
  Eigen::MatrixXd changes_;  // rows x window
  Eigen::MatrixXd mixed_;    // rows x 6, sum of weight * residual * motion^T
  Eigen::VectorXd residual_;
  int count_ = 0, next_ = 0;
};

}  // namespace palpate::published_control
