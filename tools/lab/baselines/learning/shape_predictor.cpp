#include "tools/lab/baselines/learning/shape_predictor.hpp"

#include <cmath>

namespace palpate::baselines {

ShapePredictor::ShapePredictor(const elasticity::Body& body)
    : rest_(body.mesh.nodes),
      shape_(body.mesh.nodes),
      still_(Eigen::Matrix3Xd::Zero(3, body.mesh.node_count())) {}

void ShapePredictor::reset() noexcept { shape_ = rest_; }

void ShapePredictor::activate(elasticity::DeformationModel& model) noexcept {
  reset();
  for (int g = 0; g < static_cast<int>(model.body().grasps.size()); ++g) model.release(g);
}

UpdateResult ShapePredictor::update(const estimation::EstimationInputs& inputs,
                                    elasticity::DeformationModel& model,
                                    estimation::Estimate& estimate) noexcept {
  UpdateResult result;
  if (!step_guard_.accepts(inputs.dt))
    result = {Status::kDegraded, "time step is not positive and finite"};
  result.take(predict(inputs, step_guard_.step(), shape_, estimate));
  const bool is_finite = model.restore(shape_, still_);
  estimate.step = elasticity::StepReport{
      is_finite ? elasticity::StepStatus::kConverged : elasticity::StepStatus::kFailed, 0, 0};
  estimate.log_young_modulus = std::log(model.body().material.young_modulus);
  estimate.poisson_ratio = model.body().material.poisson_ratio;
  if (!is_finite) result = {Status::kDegraded, "the predicted shape is not finite"};
  return result;
}

}  // namespace palpate::baselines
