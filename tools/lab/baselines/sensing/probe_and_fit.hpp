#pragma once

#include "tools/lab/baselines/sensing/cloud_estimator.hpp"

namespace palpate::baselines {

/// Probing followed by a fit: B. Frank, R. Schmedding, C. Stachniss, M. Teschner and W. Burgard,
/// "Learning the elasticity parameters of deformable objects with a manipulation robot", IROS 2010
/// (Sanchez 2019, Table 2.1 [26]).
///
/// Consumes: vision, the wrench, the pose of the hand, model (mesh, clamp, density, gravity), and
/// probing: the first `probing` seconds of a run, which count for its time. E and nu are estimated.
/// Kept: co-rotational finite elements; E and nu minimise the differences between simulated and
/// observed deformation and force by gradient descent (here Gauss-Newton with the model's own
/// derivatives, on points along the surface normal and on the wrench); afterwards the model with
/// these parameters predicts the shape. Left out: the paper's separate probing tool (here the
/// hand's own motion is the probe) and its registration of surfaces. nu is reported but not applied
/// to the model, because it would require another stiffness matrix, which is not feasible in the
/// loop; E is applied as in PoseWrenchFilter. Frank et al. fit offline after probing; here the
/// normal equations are accumulated in the loop and solved once probing ends. The deformation slot
/// must contain `corotational_quasistatic`.
class ProbeAndFit final : public CloudEstimator {
 public:
  struct Options : CloudEstimator::Options {
    Options() { hand = true; }
    double probing = 5;  // s since the first cloud
    /// s; the fit is repeated at this interval during probing, each time with new data
    double rounds = 1;
    double force = 0.05;  // N, standard deviation of a wrench; N m below
    double torque = 0.005;
    double period = 0.05;          // s, between two wrenches used
    double deviation = 2e-3;       // m, standard deviation of a point
    double log_young_prior = 1.5;  // prior standard deviation
    double poisson_prior = 0.2;
  };

  /// Throws std::invalid_argument if an option is out of range.
  ProbeAndFit(const elasticity::Body& body, const mesh::Surface& surface, const Options& options);

  /// (log of E relative to the configured value, nu), and their estimated standard deviations.
  Eigen::Vector2d found() const noexcept { return found_; }
  Eigen::Vector2d deviation() const noexcept { return deviation_; }
  bool is_done() const noexcept { return since_start_ >= options_.probing; }

 private:
  void begin(const Eigen::Matrix3Xd& positions) noexcept override;
  void take(elasticity::DeformationModel& model) noexcept override;
  elasticity::StepReport advance(double dt, const estimation::EstimationInputs& inputs,
                                 elasticity::DeformationModel& model) noexcept override;
  void report(estimation::Estimate& estimate) noexcept override;
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

}  // namespace palpate::baselines
