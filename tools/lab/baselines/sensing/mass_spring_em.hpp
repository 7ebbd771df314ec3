#pragma once

#include "tools/lab/baselines/sensing/cloud_estimator.hpp"

namespace palpate::baselines {

/// Mass-spring model with probabilistic correspondence: J. Schulman, A. Lee, J. Ho and P. Abbeel,
/// "Tracking deformable objects with point clouds", ICRA 2013 (Sanchez 2019, Table 2.1 [29]).
///
/// Consumes: vision, model (mesh, clamp, E, density). The pose of the hand only with `hand`. No
/// probing motions. Kept: expectation step: each point belongs to each surface node with a
/// probability that is Gaussian in its distance, or to noise; maximisation step: the forces
/// resulting from these responsibilities, sum over points of r (y - x), drive a physics simulation,
/// which also moves the unobserved nodes. Left out: visibility (the camera's position is not an
/// input, so that a hidden node is one without responsibility); colour as additional coordinates of
/// a point; estimation of the Gaussian's width. The simulation is that of the deformation slot,
/// which must be `mass_spring`, not Bullet.
class MassSpringEm final : public CloudEstimator {
 public:
  struct Options : CloudEstimator::Options {
    double stiffness = 300;  // N/m, if every point is assigned to a node; N s/m below
    double damping = 4;
    double width = 0.01;  // m, standard deviation of a point's distance from its node
    double noise = 0.05;  // prior probability that a point belongs to no node
  };

  /// Throws std::invalid_argument if an option is out of range.
  MassSpringEm(const elasticity::Body& body, const mesh::Surface& surface, const Options& options);

 private:
  void begin(const Eigen::Matrix3Xd& positions) noexcept override;
  elasticity::StepReport advance(double dt, const estimation::EstimationInputs& inputs,
                                 elasticity::DeformationModel& model) noexcept override;
  void expect(const Eigen::Vector3d& point, const Eigen::Matrix3Xd& positions) noexcept;

  Options options_;
  std::vector<int> nodes_;  // surface nodes
  estimation::ObservationInput::Points points_;
  Eigen::Index next_ = 0;
  Eigen::VectorXd share_;                        // responsibilities of one point, by surface node
  Eigen::VectorXd weight_, weight_next_;         // summed over all points, by surface node
  Eigen::Matrix3Xd attractor_, attractor_next_;  // sum of r y, m
};

}  // namespace palpate::baselines
