#pragma once

#include "core/contact/force_transformer.hpp"
#include "core/elasticity/deformation_model.hpp"
#include "core/sensing/sensor_model.hpp"

namespace palpate::estimation {

/// What is known of one grasp in a tick.
struct GraspInput {
  sensing::Freshness pose_freshness = sensing::Freshness::kNoData;
  bool holding = false;
  math::Pose X_OG = math::Pose::Identity();  // of the hand, by the robot's kinematics
  bool wrench_valid = false;
  math::Wrench F_G_O;  // of the hand on the object at the origin of G, in O, tared
};

/// Points that something sees on the object's surface; nothing is wrong where there are none.
struct ObservationInput {
  static constexpr int kMostPoints = sensing::ShapeObservation::kMostPoints;
  using Points = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMostPoints>;
  sensing::Freshness freshness = sensing::Freshness::kNoData;  // new in the tick of its arrival
  double age = 0;                                              // s since it came
  double time = 0;       // s, when seen, by the sender's clock
  double deviation = 0;  // m, of each coordinate
  Points points_O;       // m
};

struct EstimationInputs {
  double dt = 1e-3;  // s
  int grasp_count = 0;
  std::array<GraspInput, 2> grasps{};
  int contact_count = 0;
  const contact::ContactLoads* contacts = nullptr;  // contact_count of them
  ObservationInput observation;
};

/// A force on the object that no sensor tells of, found by what it does to the wrenches.
struct UnknownContact {
  bool found = false;
  Eigen::Vector3d location_O = Eigen::Vector3d::Zero();
  Eigen::Vector3d force_O = Eigen::Vector3d::Zero();  // N
  double deviation = -1;                              // N, of the force's worst direction
  double location_deviation = -1;  // m, along the surface; below zero: it is not observable
};

/// What the estimator holds to be true beside the shape itself, which stands in the model.
/// A negative deviation: not estimated, or not observable.
struct Estimate {
  elasticity::StepReport step;
  bool jumped = false;  // what the shape did in this cycle is no motion (ShapeJump, or a restart)
  std::array<math::Pose, 2> X_OG{math::Pose::Identity(), math::Pose::Identity()};
  std::array<math::Wrench, 2> reaction{};
  double log_young_modulus = 0;
  double poisson_ratio = 0;

  /// From where the kinematics have the hand to X_OG; (m, rad), in G.
  std::array<math::Vector6d, 2> pose_offset{math::Vector6d::Zero(), math::Vector6d::Zero()};
  /// (m, rad), in G; (N, N m), at G in O; bias of the wrench of the hand, at G in G.
  std::array<math::Vector6d, 2> pose_deviation{kNotEstimated, kNotEstimated};
  std::array<math::Vector6d, 2> reaction_deviation{kNotEstimated, kNotEstimated};
  std::array<math::Vector6d, 2> bias{math::Vector6d::Zero(), math::Vector6d::Zero()};
  std::array<math::Vector6d, 2> bias_deviation{kNotEstimated, kNotEstimated};
  double log_young_modulus_deviation = -1;
  double innovation_test = -1;  // normalised innovation squared, over its degrees of freedom
  UnknownContact unknown_contact;
  /// Of each mesh node's position, m, root mean square of the axes; nullptr: not estimated.
  const std::vector<float>* node_deviation = nullptr;

  /// What another estimator goes on from: where the hands are and what they feel. What this one
  /// alone told, and what lies in its own memory, is left out.
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

/// Decides what drives the deformation model and steps it once per update.
class Estimator {
 public:
  virtual ~Estimator() = default;
  /// Sets grasps held or released as this estimator needs them; called before the first update and
  /// before the model factors, so it must not step.
  virtual void activate(elasticity::DeformationModel& model) noexcept = 0;
  virtual sensing::UpdateResult update(const EstimationInputs& inputs,
                                       elasticity::DeformationModel& model,
                                       Estimate& estimate) noexcept = 0;
  virtual void reset() noexcept {}
  /// Takes the place of another estimator that held `last` to be true, beside a model that has been
  /// given the shape: activate(), but going on from there. Must not step.
  virtual void take_over(const Estimate& last, elasticity::DeformationModel& model) noexcept {
    static_cast<void>(last);
    activate(model);
  }
};

}  // namespace palpate::estimation
