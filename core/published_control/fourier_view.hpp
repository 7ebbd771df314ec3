#pragma once

#include "core/published_control/feature_view.hpp"

namespace palpate::published_control {

/// Navarro-Alarcon and Liu, "Fourier-based shape servoing: a new feedback method to actively deform
/// soft objects into desired 2-D image contours", IEEE Trans. Robotics 34(1), 2018: row [48].
///
/// Consumes: points on the object in their order (vision), the hand's pose, six probes. Kept: the
/// contour as a truncated Fourier series in its length at rest, whose coefficients are what the
/// adaptive Jacobian speaks of; what the series does not hold of the error is not steered. Left
/// out: the 2-D image and the extraction of the silhouette (3-D markers make the contour; they fix
/// its start and direction). A single point has its mean alone, where the method is plain
/// adaptation.
class FourierView final : public FeatureView {
 public:
  struct Options {
    int harmonics = 2;   // 0 to 15; fewer where the points do not tell as many
    bool closed = true;  // the last point is joined to the first
  };
  explicit FourierView(const Options& options) : options_(options) {}
  void resize(const shape::Feature& feature) override;
  int rows() const noexcept override { return static_cast<int>(analysis_.rows()); }
  void measure(const Eigen::VectorXd& value, Eigen::VectorXd& seen) noexcept override {
    seen.noalias() = analysis_.lazyProduct(value);
  }
  void express(const Eigen::MatrixXd& J_seen, Eigen::Ref<Eigen::MatrixXd> J) noexcept override {
    J.noalias() = synthesis_.lazyProduct(J_seen);
  }

 private:
  Options options_;
  Eigen::MatrixXd synthesis_;  // values x coefficients
  Eigen::MatrixXd analysis_;   // coefficients x values, its pseudo-inverse
};

}  // namespace palpate::published_control
