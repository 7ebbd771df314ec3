#pragma once

#include <optional>

#include "core/control/control_law.hpp"
#include "core/control/twist_law.hpp"

namespace palpate::baselines {

/// Wang, Li, Navarro-Alarcon and Liu, "A unified controller for region-reaching and deforming of
/// soft objects", IROS 2018: row [52] of Table 2.2 in Sanchez 2019.
///
/// Consumes: 3-D points of the object (vision), position of a fingertip, desired contact point; no
/// model, no probing motions. Kept: one law for both phases. Outside a region around the contact
/// point the gradient of a potential attracts the tip; inside, a weight increasing from 0 to 1
/// blends in the deformation term, whose Jacobian (features with respect to the tip's displacement)
/// starts from the guess that every point follows the tip and is adapted online from its prediction
/// error. The tip is a point: no rotation is commanded. Left out: the image plane (points are 3-D),
/// the transposed Jacobian and the proof based on it (here a damped inverse, as for other
/// baselines), a weight that decreases again (the contact point moves with the object). Without a
/// region, for a grasped object, only the second phase is used. Based on summaries of the paper.
class ReachThenDeform final : public control::JacobianProvider {
 public:
  struct Region {
    Eigen::Vector3d tip_G = Eigen::Vector3d::Zero();    // m, position of the fingertip, in G
    Eigen::Vector3d place_O = Eigen::Vector3d::Zero();  // m, desired contact point, in O
    double radius = 0.01;                               // m, radius of the region
  };
  struct Options {
    std::optional<Region> region;  // empty: the object is grasped
    double gain = 1;               // 1/s, gain of both terms
    double linear_speed = 0.08;    // m/s
    double hand_over = 0.5;        // s, from reaching the region to the full weight
    double update_gain = 0.3;      // (0, 2), gain of the adaptation
    double softness = 2e-3;        // m, displacement whose weight in the update is one half
    double least_motion = 1e-3;    // m, minimum motion of the tip used for learning
    /// m, displacement of the points that indicates contact of the tip
    double touch = 5e-4;
    double dead_band = 1e-3;   // m, RMS over the points
    double period = 1.0 / 30;  // s, minimum interval between two motions used for learning
  };

  /// Throws std::invalid_argument if an option is out of range or the feature does not consist of
  /// points.
  ReachThenDeform(const Options& options, const shape::Feature& feature);

  void observe(const control::Experience& now) noexcept override;
  bool update(const shape::Feature& feature, const elasticity::DeformationModel& model,
              const math::Pose& X_OG, Eigen::Ref<Eigen::MatrixXd> J) noexcept override;
  bool commands(const control::LawInputs& inputs, math::Twist& V_O_G) noexcept override;
  void reset() noexcept override;

  double weight() const noexcept { return weight_; }  // weight of the deformation term
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

}  // namespace palpate::baselines
