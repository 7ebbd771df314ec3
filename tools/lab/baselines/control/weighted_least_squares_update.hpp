#pragma once

#include <vector>

#include "tools/lab/baselines/control/jacobian_update.hpp"

namespace palpate::baselines {

/// Lagneau, Krupa and Marchal, "Active deformation through visual servoing of soft objects", ICRA
/// 2020: later than Table 2.2 in Sanchez 2019.
///
/// Consumes: feature values (vision), pose of the hand, six probing motions. Kept: weighted least
/// squares over a sliding window of motions with larger weights for newer ones; J is changed only
/// along directions sufficiently excited by the window's motions, judged by the eigenvalues of
/// their covariance. Left out: segmentation and tracking by the RGB-D camera, the selection of the
/// number of features.
class WeightedLeastSquaresUpdate final : public JacobianUpdate {
 public:
  struct Options {
    int window = 25;           // number of motions, 6 to 500
    double forgetting = 0.95;  // weight of a motion relative to the next newer one, (0, 1]
    double confidence = 0.05;  // smallest accepted eigenvalue relative to the largest
  };
  /// Throws std::invalid_argument if an option is out of range.
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

}  // namespace palpate::baselines
