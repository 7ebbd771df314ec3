#pragma once

#include "tools/lab/baselines/sensing/cloud_estimator.hpp"

namespace palpate::baselines {

/// Point-cloud driven co-rotational finite elements: A. Petit, V. Lippiello and B. Siciliano,
/// "Real-time tracking of 3D elastic objects with an RGB-D sensor", IROS 2015 (Sanchez 2019, Table
/// 2.1 [33]; [36] is probed_cloud_fem, [40] adds further bodies).
///
/// Consumes: vision, model (mesh, clamp, E, nu, density, gravity). The pose of the hand only with
/// `hand`. No probing motions. Kept: co-rotational tetrahedra with implicit dynamics; in each tick
/// springs between the points of the cloud and the nearest surface points (iterative closest
/// points) act as external nodal forces; Rayleigh damping. Left out: segmentation, visibility by
/// rendering and the weights by texture and contour, because the input consists of points only;
/// springs from occluded surface points. The deformation slot must contain `corotational_dynamic`:
/// with a quasi-static model springs that are not part of its matrix are unstable.
class CloudDrivenFem final : public CloudEstimator {
 public:
  struct Options : CloudEstimator::Options {
    double stiffness = 600;  // N/m, total of all springs; N s/m below
    double damping = 4;
  };

  /// Throws std::invalid_argument if an option is out of range.
  CloudDrivenFem(const elasticity::Body& body, const mesh::Surface& surface,
                 const Options& options);

 private:
  void begin(const Eigen::Matrix3Xd& positions) noexcept override;
  elasticity::StepReport advance(double dt, const estimation::EstimationInputs& inputs,
                                 elasticity::DeformationModel& model) noexcept override;
  double stiffness_, damping_;
};

}  // namespace palpate::baselines
