#pragma once

#include "tools/lab/baselines/control/feature_view.hpp"

namespace palpate::baselines {

/// Navarro-Alarcon and Liu, "Fourier-based shape servoing: a new feedback method to actively deform
/// soft objects into desired 2-D image contours", IEEE Trans. Robotics 34(1), 2018: row [48] of
/// Table 2.2 in Sanchez 2019.
///
/// Consumes: ordered points on the object (vision), pose of the hand, six probing motions. Kept:
/// the contour as a truncated Fourier series in its arc length at rest, whose coefficients are the
/// output of the adaptive Jacobian; error components outside the series are not controlled. Left
/// out: the 2-D image and the extraction of the silhouette (3-D markers form the contour and fix
/// its start and direction). A single point is represented by its mean, for which the method is
/// plain adaptation.
class FourierView final : public FeatureView {
 public:
  struct Options {
    int harmonics = 2;   // 0 to 15; fewer if the number of points does not suffice
    bool closed = true;  // the last point is connected to the first
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
  Eigen::MatrixXd analysis_;   // coefficients x values, pseudo-inverse of synthesis_
};

}  // namespace palpate::baselines
