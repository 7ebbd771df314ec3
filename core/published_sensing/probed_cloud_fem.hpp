#pragma once

#include "core/published_sensing/cloud_estimator.hpp"

namespace palpate::published_sensing {

/// Finite elements driven by a cloud, whose stiffness a force has told before: A. Petit,
/// F. Ficuciello, G. A. Fontanelli, L. Villani and B. Siciliano, "Using physical modeling and RGB-D
/// registration for contact force sensing on deformable objects", ICINCO 2017 (thesis [36]).
///
/// Consumes: vision, the hand's pose (where the object is pushed), the wrench and probes for the
/// first `probing` seconds of a run, which its time counts; model (mesh, clamp, density, gravity;
/// of E a first guess).
/// Kept: a first phase in which E is the one under which the simulated force of the contact changes
/// most nearly as the measured one does, found once at its end; then [33]: co-rotational finite
/// elements with implicit dynamics, drawn along by springs from the cloud, now with that E; and the
/// force that the model then tells. Left out: what [33] leaves out; nu, which its force hardly
/// shows. A model of a stiffness k times as large is the same under springs and weights k times as
/// weak, which is how E is applied. The deformation slot is to hold `corotational_dynamic`. Written
/// from summaries of the work.
class ProbedCloudFem final : public CloudEstimator {
 public:
  struct Options : CloudEstimator::Options {
    Options() { hand = true; }
    double stiffness = 600;  // N/m, of all springs together; N s/m below
    double damping = 4;
    double probing = 5;   // s since the first cloud
    double force = 0.01;  // N, changes that are smaller tell nothing
  };

  /// Throws std::invalid_argument where an option is out of range.
  ProbedCloudFem(const elasticity::Body& body, const mesh::Surface& surface,
                 const Options& options);

  double found() const noexcept { return found_; }  // E over that of the configuration

 private:
  void begin(const Eigen::Matrix3Xd& positions) noexcept override;
  elasticity::StepReport advance(double dt, const estimation::EstimationInputs& inputs,
                                 elasticity::DeformationModel& model) noexcept override;
  void tell(estimation::Estimate& estimate) noexcept override;
  void compare_forces(const estimation::EstimationInputs& inputs,
                      const elasticity::DeformationModel& model) noexcept;

  Options options_;
  double nominal_log_young_;
  double found_ = 1;
  double since_start_ = 0;                            // s
  Eigen::Vector3d first_measured_, first_simulated_;  // N, of the first grasp
  double common_ = 0, simulated_ = 0;  // N^2, sums of products: of both forces, of the simulated
};

}  // namespace palpate::published_sensing
