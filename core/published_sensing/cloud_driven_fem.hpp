#pragma once

#include "core/published_sensing/cloud_estimator.hpp"

namespace palpate::published_sensing {

/// Point-cloud driven co-rotational finite elements: A. Petit, V. Lippiello and B. Siciliano,
/// "Real-time tracking of 3D elastic objects with an RGB-D sensor", IROS 2015 (thesis [33]; [36]
/// is probed_cloud_fem, [40] adds further bodies).
///
/// Consumes: vision, model (mesh, clamp, E, nu, density, gravity). Not the hand's pose, unless
/// `hand`. No probes.
/// Kept: co-rotational tetrahedra with implicit dynamics; each tick springs from the points of the
/// cloud to the nearest places of the surface (iterated closest points) as external forces on
/// nodes; Rayleigh damping.
/// Left out: segmentation, visibility by rendering and the weights by texture and contour, since
/// the port gives points alone; springs from hidden places to points. The deformation slot is to
/// hold `corotational_dynamic`: on a quasi-static model springs that are not part of its matrix
/// are not stable.
class CloudDrivenFem final : public CloudEstimator {
 public:
  struct Options : CloudEstimator::Options {
    double stiffness = 600;  // N/m, of all springs together; N s/m below
    double damping = 4;
  };

  /// Throws std::invalid_argument where an option is out of range.
  CloudDrivenFem(const elasticity::Body& body, const mesh::Surface& surface,
                 const Options& options);

 private:
  void begin(const Eigen::Matrix3Xd& positions) noexcept override;
  elasticity::StepReport advance(double dt, const estimation::EstimationInputs& inputs,
                                 elasticity::DeformationModel& model) noexcept override;
  double stiffness_, damping_;
};

}  // namespace palpate::published_sensing
