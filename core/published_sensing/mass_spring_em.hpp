#pragma once

#include "core/published_sensing/cloud_estimator.hpp"

namespace palpate::published_sensing {

/// Mass-spring with probabilistic correspondence: J. Schulman, A. Lee, J. Ho and P. Abbeel,
/// "Tracking deformable objects with point clouds", ICRA 2013 (thesis [29]).
///
/// Consumes: vision, model (mesh, clamp, E, density). Not the hand's pose, unless `hand`. No
/// probes. Kept: expectation: each point belongs to each node of the surface by a Gaussian of its
/// distance, or to noise; maximisation: the forces that these responsibilities exert, sum over
/// points of r (y - x), move a physical simulation, which also carries the nodes that nothing sees.
/// Left out: visibility (the port does not say where the camera stands, so that a hidden node is
/// one with no responsibility); colour as further coordinates of a point; the fit of the Gaussian's
/// width. The simulation is that of the deformation slot, to be `mass_spring`, not Bullet's.
class MassSpringEm final : public CloudEstimator {
 public:
  struct Options : CloudEstimator::Options {
    double stiffness = 300;  // N/m, when every point has its node; N s/m below
    double damping = 4;
    double width = 0.01;  // m, standard deviation of a point about its node
    double noise = 0.05;  // prior share of points that belong to no node
  };

  /// Throws std::invalid_argument where an option is out of range.
  MassSpringEm(const elasticity::Body& body, const mesh::Surface& surface, const Options& options);

 private:
  void begin(const Eigen::Matrix3Xd& positions) noexcept override;
  elasticity::StepReport advance(double dt, const estimation::EstimationInputs& inputs,
                                 elasticity::DeformationModel& model) noexcept override;
  void expect(const Eigen::Vector3d& point, const Eigen::Matrix3Xd& positions) noexcept;

  Options options_;
  std::vector<int> nodes_;  // of the surface
  estimation::ObservationInput::Points points_;
  Eigen::Index next_ = 0;
  Eigen::VectorXd share_;                        // of one point, by surface node
  Eigen::VectorXd weight_, weight_next_;         // of all points, by surface node
  Eigen::Matrix3Xd attractor_, attractor_next_;  // sum of r y, m
};

}  // namespace palpate::published_sensing
