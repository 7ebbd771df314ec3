#pragma once

#include "core/contact/force_transformer.hpp"
#include "core/elasticity/deformation_model.hpp"
#include "core/estimation/discrepancy_report.hpp"
#include "core/math/update_result.hpp"
#include "core/sensing/sensor_model.hpp"

namespace palpate::estimation {

/// Inputs of one grasp in one tick.
struct GraspInput {
  Freshness pose_freshness = Freshness::kNoData;
  bool holding = false;
  math::Pose X_OG = math::Pose::Identity();  // pose of the hand, from the forward kinematics
  bool wrench_valid = false;
  math::Wrench F_G_O;  // tared wrench of the hand on the object at the origin of G, in O
  /// Covariance of the lasting errors of F_G_O by direction (sensing::Contact); zero: not known.
  math::Matrix6d covariance = math::Matrix6d::Zero();
};

/// Observed points on the object's surface. May be empty.
struct ObservationInput {
  static constexpr int kMostPoints = sensing::ShapeObservation::kMostPoints;
  using Points = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMostPoints>;
  /// kNewData only in the tick of arrival
  Freshness freshness = Freshness::kNoData;
  double age = 0;        // s since arrival
  double time = 0;       // s, acquisition time by the sender's clock
  double deviation = 0;  // m, standard deviation of each coordinate
  Points points_O;       // m
};

struct EstimationInputs {
  double dt = 1e-3;  // s
  int grasp_count = 0;
  std::array<GraspInput, 2> grasps{};
  int contact_count = 0;
  const contact::ContactLoads* contacts = nullptr;  // array of contact_count loads
  ObservationInput observation;
};

/// External force on the object that no sensor measures directly, estimated from its effect on the
/// wrenches.
struct UnknownContact {
  bool found = false;
  Eigen::Vector3d location_O = Eigen::Vector3d::Zero();
  Eigen::Vector3d force_O = Eigen::Vector3d::Zero();  // N
  /// N, standard deviation in the worst direction
  double deviation = -1;
  /// m, standard deviation along the surface; negative: not observable
  double location_deviation = -1;
};

/// Estimated quantities other than the shape itself, which the model holds. A negative deviation
/// means "not estimated" or "not observable".
struct Estimate {
  elasticity::StepReport step;
  /// The change of shape in this cycle is a discontinuity, not a motion (ShapeJump, or a restart).
  bool jumped = false;
  std::array<math::Pose, 2> X_OG{math::Pose::Identity(), math::Pose::Identity()};
  std::array<math::Wrench, 2> reaction{};
  double log_young_modulus = 0;
  double poisson_ratio = 0;

  /// Offset from the kinematic pose of the hand to X_OG; (m, rad), in G.
  std::array<math::Vector6d, 2> pose_offset{math::Vector6d::Zero(), math::Vector6d::Zero()};
  /// Standard deviations: pose (m, rad), in G; reaction (N, N m), at G in O; bias of the wrench of
  /// the hand, at G in G.
  std::array<math::Vector6d, 2> pose_deviation{kNotEstimated, kNotEstimated};
  std::array<math::Vector6d, 2> reaction_deviation{kNotEstimated, kNotEstimated};
  std::array<math::Vector6d, 2> bias{math::Vector6d::Zero(), math::Vector6d::Zero()};
  std::array<math::Vector6d, 2> bias_deviation{kNotEstimated, kNotEstimated};
  double log_young_modulus_deviation = -1;
  /// Motion of obstacles from their configured poses, by free direction (collision), that the shape
  /// follows, and its standard deviations; m, rad, in B.
  collision::FreeMotion obstacle_motion{}, obstacle_deviation{};
  double innovation_test = -1;  // normalised innovation squared per degree of freedom
  UnknownContact unknown_contact;
  /// Standard deviation of each mesh node's position, m, root mean square over the axes; nullptr:
  /// not estimated.
  const std::vector<float>* node_deviation = nullptr;
  /// Consistency of the wrenches with the model; nullptr: not tested.
  const DiscrepancyReport* discrepancy = nullptr;

  /// Part of the estimate that is handed to a replacement estimator: poses and wrenches of the
  /// hands. Excludes quantities specific to this estimator and pointers into its memory.
  Estimate handed_over() const noexcept {
    Estimate next;
    next.step = step;
    next.X_OG = X_OG;
    next.reaction = reaction;
    next.log_young_modulus = log_young_modulus;
    next.poisson_ratio = poisson_ratio;
    return next;
  }

 private:
  static inline const math::Vector6d kNotEstimated = math::Vector6d::Constant(-1);
};

/// Determines the boundary conditions of the deformation model from the measurements and steps the
/// model once per update.
class Estimator {
 public:
  virtual ~Estimator() = default;
  /// Sets grasps held or released as this estimator needs them. Called before the first update and
  /// before the model factors, therefore it must not step the model.
  virtual void activate(elasticity::DeformationModel& model) noexcept = 0;
  virtual UpdateResult update(const EstimationInputs& inputs, elasticity::DeformationModel& model,
                              Estimate& estimate) noexcept = 0;
  virtual void reset() noexcept {}
  /// Replaces another estimator whose last estimate was `last`; the model already has the shape.
  /// Like activate(), but continues from that state. Must not step the model.
  virtual void take_over(const Estimate& last, elasticity::DeformationModel& model) noexcept {
    static_cast<void>(last);
    activate(model);
  }
};

}  // namespace palpate::estimation
