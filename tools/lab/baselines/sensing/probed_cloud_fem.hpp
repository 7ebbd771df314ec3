#pragma once

#include "tools/lab/baselines/sensing/cloud_estimator.hpp"

namespace palpate::baselines {

/// Finite elements driven by a point cloud, after identification of their stiffness from forces: A.
/// Petit, F. Ficuciello, G. A. Fontanelli, L. Villani and B. Siciliano, "Using physical modeling
/// and RGB-D registration for contact force sensing on deformable objects", ICINCO 2017 (Sanchez
/// 2019, Table 2.1 [36]).
///
/// Consumes: vision, the pose of the hand (contact point), the wrench and probing for the first
/// `probing` seconds of a run, which count for its time; model (mesh, clamp, density, gravity; E as
/// an initial guess). Kept: a first phase that determines, once at its end, the E for which the
/// changes of the simulated contact force match those of the measured one best; then [33] with this
/// E: co-rotational finite elements with implicit dynamics, driven by springs to the cloud; and the
/// force predicted by the model. Left out: the parts omitted from [33]; nu, to which the force is
/// insensitive. A model k times as stiff is equivalent to one with springs and weight divided by k,
/// which is how E is applied. The deformation slot must contain `corotational_dynamic`. Based on
/// summaries of the work.
class ProbedCloudFem final : public CloudEstimator {
 public:
  struct Options : CloudEstimator::Options {
    Options() { hand = true; }
    double stiffness = 600;  // N/m, total of all springs; N s/m below
    double damping = 4;
    double probing = 5;   // s since the first cloud
    double force = 0.01;  // N, smaller changes are not informative
  };

  /// Throws std::invalid_argument if an option is out of range.
  ProbedCloudFem(const elasticity::Body& body, const mesh::Surface& surface,
                 const Options& options);

  double found() const noexcept { return found_; }  // estimated E relative to the configured value

 private:
  void begin(const Eigen::Matrix3Xd& positions) noexcept override;
  elasticity::StepReport advance(double dt, const estimation::EstimationInputs& inputs,
                                 elasticity::DeformationModel& model) noexcept override;
  void report(estimation::Estimate& estimate) noexcept override;
  void compare_forces(const estimation::EstimationInputs& inputs,
                      const elasticity::DeformationModel& model) noexcept;

  Options options_;
  double nominal_log_young_;
  double found_ = 1;
  double since_start_ = 0;                            // s
  Eigen::Vector3d first_measured_, first_simulated_;  // N, initial forces of grasp 0
  /// N^2, sums of products: of both forces, of the simulated one with itself
  double common_ = 0, simulated_ = 0;
};

}  // namespace palpate::baselines
