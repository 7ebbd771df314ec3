#pragma once

#include "core/published_control/probes.hpp"

namespace palpate::published_control {

/// Hu, Sun and Pan, "Three-dimensional deformable object manipulation using fast online Gaussian
/// process regression", IEEE Robotics and Automation Letters 3(2), 2018: row [41] of Table 2.2.
///
/// Consumes: 3-D feature points (vision), the hand's pose, six probes; no model. Kept: Gaussian
/// process regression of the inverse deformation function, from the feature's motion to the hand's,
/// with a squared-exponential kernel; online, with the least informative of its samples (the one
/// most like the newest) dropped where there are too many; the hand moves as is predicted for the
/// wished motion of the feature. Left out: their block-wise update of the inverse (a Cholesky
/// factor of at most 80 samples is computed anew), tuning of the kernel by likelihood, occlusion
/// handling. The wish is cut to the size of what has been seen, beyond which the process knows
/// nothing, and the answer scaled up again.
class GaussianProcess final : public control::JacobianProvider {
 public:
  static constexpr int kMostSamples = 80;

  struct Options {
    ProbeOptions probes;
    double period = 1.0 / 30;    // s between samples, at least
    double least_motion = 1e-3;  // m, of the hand (rotations times `length`)
    double length = 0.1;         // m, by which rotations are scaled
    double reach = 1;            // kernel's length by the mean size of the samples
    double noise = 0.1;          // deviation of a hand's motion by the mean size of those
    double gain = 1;             // 1/s, of the feature's error
    double linear_speed = 0.08;  // m/s
    double angular_speed = 0.5;  // rad/s
    double dead_band = 1e-3;     // m, of the error by point, in which the hand rests
    int samples = kMostSamples;  // at most
  };
  /// Throws std::invalid_argument where an option is out of range or the feature cannot be learnt.
  GaussianProcess(const Options& options, const shape::Feature& feature);

  void observe(const control::Experience& now) noexcept override;
  /// Never a Jacobian: the process moves the hand itself.
  bool update(const shape::Feature&, const elasticity::DeformationModel&, const math::Pose&,
              Eigen::Ref<Eigen::MatrixXd>) noexcept override {
    return false;
  }
  bool commands(const control::LawInputs& inputs, math::Twist& V_O_G) noexcept override;
  void reset() noexcept override;

  int sample_count() const noexcept { return count_; }
  /// The hand's motion (rotations times length) that is expected to move the feature by `change`.
  math::Vector6d predict(const Eigen::VectorXd& change) noexcept;
  /// Adds what a motion of the hand has done.
  void add(const math::Vector6d& motion, const Eigen::VectorXd& change) noexcept;

 private:
  double kernel(double square) const noexcept;
  void fit() noexcept;
  math::Vector6d motion_since(const math::Pose& X_OG) const noexcept;

  using Gram = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostSamples, kMostSamples>;

  Options options_;
  Probes probes_;
  Eigen::MatrixXd changes_;  // feature x samples
  Eigen::Matrix<double, kMostSamples, 6> motions_, weights_;
  Eigen::MatrixXd gram_, factor_;  // kMostSamples square
  int count_ = 0;
  double size_ = 0;         // mean |change|
  double motion_size_ = 0;  // mean |motion|
  double points_ = 1;
  Eigen::VectorXd last_, change_, wish_;
  math::Pose X_last_ = math::Pose::Identity();
  double since_ = 0;
  bool begun_ = false;
};

}  // namespace palpate::published_control
