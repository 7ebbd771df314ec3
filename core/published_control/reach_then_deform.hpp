#pragma once

#include <optional>

#include "core/control/control_law.hpp"
#include "core/control/dead_band.hpp"

namespace palpate::published_control {

/// Wang, Li, Navarro-Alarcon and Liu, "A unified controller for region-reaching and deforming of
/// soft objects", IROS 2018: row [52].
///
/// Consumes: 3-D points of the object (vision), the place of a fingertip, where it is to touch; no
/// model, no probes. Kept: one law for both phases. Outside a region about the place of contact the
/// gradient of a potential draws the tip there; inside, a weight that grows from 0 to 1 hands over
/// to the deformation's own term, whose Jacobian (features by the tip's displacement) starts as a
/// guess, that every point goes along with the tip, and is adapted on line by the error of its
/// prediction. The tip is a point: no rotation is commanded. Left out: the image plane (points are
/// 3-D), the transposed Jacobian and the proof that rests on it (a damped inverse, as others here
/// have), a weight that falls again (the place of contact goes along with the object). Without a
/// region, of an object in the hand, the second phase alone. Written from summaries of the paper.
class ReachThenDeform final : public control::JacobianProvider {
 public:
  struct Region {
    Eigen::Vector3d tip_G = Eigen::Vector3d::Zero();    // m, of the fingertip, in G
    Eigen::Vector3d place_O = Eigen::Vector3d::Zero();  // m, where it is to touch, in O
    double radius = 0.01;                               // m, of the region
  };
  struct Options {
    std::optional<Region> region;  // none: the object is in the hand
    double gain = 1;               // 1/s, of either term
    double linear_speed = 0.08;    // m/s
    double hand_over = 0.5;        // s, from when the region is reached to the full weight
    double update_gain = 0.3;      // (0, 2), of the adaptation
    double softness = 2e-3;        // m, motion that counts as half a motion
    double least_motion = 1e-3;    // m, of the tip, that is learnt from
    double touch = 5e-4;           // m, motion of the points from which the tip is known to touch
    double dead_band = 1e-3;       // m, RMS over the points
    double period = 1.0 / 30;      // s between two motions that are learnt from, at least
  };

  /// Throws std::invalid_argument where an option is out of range or the feature is not of points.
  ReachThenDeform(const Options& options, const shape::Feature& feature);

  void observe(const control::Experience& now) noexcept override;
  bool update(const shape::Feature& feature, const elasticity::DeformationModel& model,
              const math::Pose& X_OG, Eigen::Ref<Eigen::MatrixXd> J) noexcept override;
  bool commands(const control::LawInputs& inputs, math::Twist& V_O_G) noexcept override;
  void reset() noexcept override;

  double weight() const noexcept { return weight_; }  // of the deformation's term
  const Eigen::Matrix<double, Eigen::Dynamic, 3>& jacobian() const noexcept { return J_; }

 private:
  Eigen::Vector3d tip() const noexcept;

  Options options_;
  control::DeadBand dead_band_;
  Eigen::Matrix<double, Eigen::Dynamic, 3> J_;
  Eigen::VectorXd first_, last_, residual_;
  Eigen::Vector3d last_tip_ = Eigen::Vector3d::Zero();
  math::Pose X_OG_ = math::Pose::Identity();
  double weight_ = 0, since_ = 0, points_ = 1;
  bool begun_ = false, touching_ = false;
};

}  // namespace palpate::published_control
