#pragma once

#include "core/estimation/estimator.hpp"
#include "core/estimation/step_watch.hpp"

namespace palpate::baselines {

/// Base of the baselines that predict the shape without mechanics, in the estimation slot of
/// palpated. The prediction becomes the state, at rest, of the model in the deformation slot, which
/// is never stepped; its grasps are released.
class ShapePredictor : public estimation::Estimator {
 public:
  void activate(elasticity::DeformationModel& model) noexcept final;
  /// Degraded if the prediction is, if it is not finite, or if the time step is not positive and
  /// finite.
  UpdateResult update(const estimation::EstimationInputs& inputs,
                      elasticity::DeformationModel& model,
                      estimation::Estimate& estimate) noexcept final;
  void reset() noexcept override;

 protected:
  explicit ShapePredictor(const elasticity::Body& body);

  const Eigen::Matrix3Xd& rest() const noexcept { return rest_; }  // m, 3 x nodes

 private:
  /// Replaces `shape`, that of the last tick. `step`: s. May write estimates other than the shape.
  virtual UpdateResult predict(const estimation::EstimationInputs& inputs, double step,
                               Eigen::Matrix3Xd& shape,
                               estimation::Estimate& estimate) noexcept = 0;

  Eigen::Matrix3Xd rest_, shape_, still_;
  estimation::StepGuard step_guard_;
};

}  // namespace palpate::baselines
