#pragma once

#include "tools/lab/baselines/control/probes.hpp"

namespace palpate::baselines {

/// Hu, Sun and Pan, "Three-dimensional deformable object manipulation using fast online Gaussian
/// process regression", IEEE Robotics and Automation Letters 3(2), 2018: row [41] of Table 2.2 in
/// Sanchez 2019.
///
/// Consumes: 3-D feature points (vision), pose of the hand, six probing motions; no model. Kept:
/// Gaussian process regression of the inverse deformation function, from the feature's motion to
/// the hand's, with a squared-exponential kernel; online, dropping the least informative sample
/// (the one most similar to the newest) when the capacity is exceeded; the hand performs the motion
/// predicted for the desired motion of the feature. Left out: their block-wise update of the
/// inverse (here a Cholesky factor of at most 80 samples is recomputed), likelihood tuning of the
/// kernel, occlusion handling. The desired motion is scaled to the magnitude of the samples, beyond
/// which the process has no information, and the prediction is scaled back.
class GaussianProcess final : public control::JacobianProvider {
 public:
  static constexpr int kMostSamples = 80;

  struct Options {
    ProbeOptions probes;
    double period = 1.0 / 30;  // s, minimum interval between samples
    /// m, minimum motion of the hand for a sample (rotations times `length`)
    double least_motion = 1e-3;
    double length = 0.1;  // m, length that scales rotations
    /// Length scale of the kernel relative to the mean norm of the samples.
    double reach = 1;
    double noise = 0.1;          // noise of a hand's motion relative to their mean norm
    double gain = 1;             // 1/s, gain on the feature's error
    double linear_speed = 0.08;  // m/s
    double angular_speed = 0.5;  // rad/s
    double dead_band = 1e-3;     // m, error per point below which the hand rests
    int samples = kMostSamples;  // maximum number
  };
  /// Throws std::invalid_argument if an option is out of range or the feature is not supported.
  GaussianProcess(const Options& options, const shape::Feature& feature);

  void observe(const control::Experience& now) noexcept override;
  /// Always false: the process commands the hand directly.
  bool update(const shape::Feature&, const elasticity::DeformationModel&, const math::Pose&,
              Eigen::Ref<Eigen::MatrixXd>) noexcept override {
    return false;
  }
  bool commands(const control::LawInputs& inputs, math::Twist& V_O_G) noexcept override;
  void reset() noexcept override;

  int sample_count() const noexcept { return count_; }
  /// Predicted motion of the hand (rotations times length) that moves the feature by `change`.
  math::Vector6d predict(const Eigen::VectorXd& change) noexcept;
  /// Adds a motion of the hand and the resulting change of the feature.
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
  Eigen::MatrixXd gram_, factor_;  // kMostSamples x kMostSamples
  int count_ = 0;
  double size_ = 0;         // mean |change|
  double motion_size_ = 0;  // mean |motion|
  double points_ = 1;
  Eigen::VectorXd last_, change_, wish_;
  math::Pose X_last_ = math::Pose::Identity();
  double since_ = 0;
  bool begun_ = false;
};

}  // namespace palpate::baselines
