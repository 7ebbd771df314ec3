#pragma once

#include "core/published_sensing/cloud_estimator.hpp"

namespace palpate::published_sensing {

/// Probe, then fit: B. Frank, R. Schmedding, C. Stachniss, M. Teschner and W. Burgard, "Learning
/// the elasticity parameters of deformable objects with a manipulation robot", IROS 2010 (thesis
/// [26]).
///
/// Consumes: vision, the wrench, the hand's pose, model (mesh, clamp, density, gravity), and
/// probes: the first `probing` seconds of a run, which its time counts. E and nu are what it finds.
/// Kept: co-rotational finite elements; E and nu are those under which simulated and observed
/// deformation and force differ least, by gradient descent (here Gauss and Newton with the model's
/// own derivatives, for points along the surface's normal and for the wrench); afterwards the model
/// with these predicts the shape.
/// Left out: the paper's separate probing tool (here the hand's own motion is the probe) and its
/// registration of surfaces. nu is told but the model keeps its own, since another one needs
/// another stiffness matrix, which is no work for the loop; E is applied as in PoseWrenchFilter.
/// Frank et al. fit after the probing, off line; here the sums are kept in the loop and solved
/// once, as the probing ends. The deformation slot is to hold `corotational_quasistatic`.
class ProbeAndFit final : public CloudEstimator {
 public:
  struct Options : CloudEstimator::Options {
    Options() { hand = true; }
    double probing = 5;   // s since the first cloud
    double rounds = 1;    // s; the fit is repeated within the probing, each with new data
    double force = 0.05;  // N, deviation of a wrench; N m below
    double torque = 0.005;
    double period = 0.05;          // s, between two wrenches that are taken
    double deviation = 2e-3;       // m, of a point
    double log_young_prior = 1.5;  // deviation
    double poisson_prior = 0.2;
  };

  /// Throws std::invalid_argument where an option is out of range.
  ProbeAndFit(const elasticity::Body& body, const mesh::Surface& surface, const Options& options);

  /// (log E over that of the configuration, nu); the deviations that the fit gives itself.
  Eigen::Vector2d found() const noexcept { return found_; }
  Eigen::Vector2d deviation() const noexcept { return deviation_; }
  bool is_done() const noexcept { return since_start_ >= options_.probing; }

 private:
  void begin(const Eigen::Matrix3Xd& positions) noexcept override;
  void take(elasticity::DeformationModel& model) noexcept override;
  elasticity::StepReport advance(double dt, const estimation::EstimationInputs& inputs,
                                 elasticity::DeformationModel& model) noexcept override;
  void tell(estimation::Estimate& estimate) noexcept override;
  void add(const Eigen::Vector2d& slope, double residual, double deviation) noexcept;
  void add_wrench(int grasp, const estimation::GraspInput& input,
                  const elasticity::DeformationModel& model) noexcept;
  void solve() noexcept;

  Options options_;
  double nominal_poisson_;
  double nominal_log_young_;
  double since_start_ = 0, since_solved_ = 0, since_wrench_ = 0;  // s
  Eigen::Vector2d found_, deviation_;
  Eigen::Matrix2d information_;
  Eigen::Vector2d vector_;
};

}  // namespace palpate::published_sensing
