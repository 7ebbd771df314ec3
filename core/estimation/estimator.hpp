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

struct EstimationInputs {
  double dt = 1e-3;  // s
  int grasp_count = 0;
  std::array<GraspInput, 2> grasps{};
  int contact_count = 0;
  const contact::ContactLoads* contacts = nullptr;  // contact_count of them
};

/// What the estimator holds to be true beside the shape itself, which stands in the model.
/// A negative deviation: not estimated.
struct Estimate {
  elasticity::StepReport step;
  std::array<math::Pose, 2> X_OG{math::Pose::Identity(), math::Pose::Identity()};
  std::array<math::Wrench, 2> reaction{};
  double log_young_modulus = 0;
  double poisson_ratio = 0;
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
