#pragma once

#include <array>
#include <vector>

#include "core/math/rigid.hpp"
#include "tools/lab/baselines/control/feature_view.hpp"

namespace palpate::baselines {

/// Navarro-Alarcon, Liu, Romero and Li, "On the visual deformation servoing of compliant objects:
/// uncalibrated control methods and experiments", Int. J. Robotics Research 33(11), 2014: row [45]
/// of Table 2.2 in Sanchez 2019.
///
/// Consumes: points in the images of two cameras (vision), pose of the hand, six probing motions.
/// Kept: stacked image features of several views, whose Jacobian is learnt without calibration (see
/// GradientUpdate). Left out: real images; two ideal pinhole cameras project the tracked points.
/// The task error is 3-D, therefore the Jacobian learnt in the images is converted by the cameras'
/// own Jacobian, whereas the paper controls in the images.
class TwoCameraView final : public FeatureView {
 public:
  struct Options {
    std::array<Eigen::Vector3d, 2> eyes_O{Eigen::Vector3d(0.25, -1.0, 0.4),
                                          Eigen::Vector3d(0.25, 0.5, 1.1)};
    Eigen::Vector3d target_O{0.25, 0.03, 0.03};
    double focal = 600;  // px
  };
  /// Throws std::invalid_argument if an eye coincides with the target or the focal length is not
  /// positive.
  explicit TwoCameraView(const Options& options);
  void resize(const shape::Feature& feature) override;
  int rows() const noexcept override { return 4 * points_; }
  void measure(const Eigen::VectorXd& value, Eigen::VectorXd& seen) noexcept override;
  void express(const Eigen::MatrixXd& J_seen, Eigen::Ref<Eigen::MatrixXd> J) noexcept override;

 private:
  Options options_;
  std::array<math::Pose, 2> X_CO_{math::Pose::Identity(), math::Pose::Identity()};
  int points_ = 0;
  std::vector<Eigen::Matrix<double, 4, 3>> by_point_;  // d pixels / d point
};

}  // namespace palpate::baselines
