#include "tools/lab/baselines/learning/learned_shape.hpp"

#include <cmath>
#include <stdexcept>

namespace palpate::baselines {

void LearnedShape::gather(Inputs inputs, const Eigen::Vector3d& force_O, const math::Pose& X_OG,
                          const math::Pose& X_OG_rest, Eigen::VectorXd& into) noexcept {
  const Eigen::Vector3d place = X_OG.translation() - X_OG_rest.translation();
  if (inputs == Inputs::kPosition) {
    into.head<3>() = force_O;
    into.segment<3>(3) = place;
    return;
  }
  into[0] = force_O.norm();
  into.segment<3>(1) = math::log_rotation(X_OG.linear() * X_OG_rest.linear().transpose());
  into.segment<3>(4) = place;
}

LearnedShape::LearnedShape(const elasticity::Body& body, const Model& model, double average)
    : model_(model), average_(average), rest_(body.mesh.nodes), shape_(body.mesh.nodes) {
  model_.network.check();
  if (model_.units.cols() < 1 || !model_.units.allFinite() ||
      model_.network.outputs() != 3 * model_.units.cols() ||
      model_.network.inputs() != input_count(model_.inputs))
    throw std::invalid_argument("a learned shape's units, inputs and network do not agree");
  if (body.grasps.empty()) throw std::invalid_argument("a learned shape wants a hand that holds");
  if (!(average > 0)) throw std::invalid_argument("average of a learned shape must be positive");
  rest_pose_ = body.grasps[0].X_OG_rest;
  still_.setZero(3, rest_.cols());
  input_.setZero(model_.network.inputs());
  room_.setZero(model_.network.hidden.rows());
  output_.setZero(model_.network.outputs());
  // Gaussians as wide as the distance between units, so that a linear field of the units is
  // interpolated smoothly.
  const Eigen::Index units = model_.units.cols();
  double apart = 0;
  for (Eigen::Index u = 0; u < units; ++u) {
    double least = 1e300;
    for (Eigen::Index k = 0; k < units; ++k)
      if (k != u) least = std::min(least, (model_.units.col(u) - model_.units.col(k)).norm());
    apart += least / static_cast<double>(units);
  }
  const double scale = -0.5 / std::max(1e-12, apart * apart);
  spread_.resize(rest_.cols(), units);
  for (Eigen::Index n = 0; n < rest_.cols(); ++n) {
    const Eigen::RowVectorXd squared =
        (model_.units.colwise() - rest_.col(n)).colwise().squaredNorm();
    spread_.row(n) = (scale * (squared.array() - squared.minCoeff())).exp();
    spread_.row(n) /= spread_.row(n).sum();
  }
}

void LearnedShape::reset() noexcept {
  force_.setZero();
  felt_ = false;
  shape_ = rest_;
}

void LearnedShape::activate(elasticity::DeformationModel& model) noexcept {
  reset();
  for (int g = 0; g < static_cast<int>(model.body().grasps.size()); ++g) model.release(g);
}

UpdateResult LearnedShape::update(const estimation::EstimationInputs& inputs,
                                  elasticity::DeformationModel& model,
                                  estimation::Estimate& estimate) noexcept {
  UpdateResult result;
  if (!step_guard_.accepts(inputs.dt))
    result = {Status::kDegraded, "time step is not positive and finite"};
  const estimation::GraspInput& grasp = inputs.grasps[0];
  if (inputs.grasp_count < 1 || grasp.pose_freshness == Freshness::kNoData ||
      !grasp.X_OG.matrix().allFinite() || !grasp.wrench_valid || !grasp.F_G_O.force.allFinite()) {
    result = {Status::kDegraded, "wrench or pose of the hand lacks"};
  } else {
    const double share = felt_ ? 1 - std::exp(-step_guard_.step() / average_) : 1;
    force_ += share * (grasp.F_G_O.force - force_);
    felt_ = true;
    gather(model_.inputs, force_, grasp.X_OG, rest_pose_, input_);
    model_.network.evaluate(input_, room_, output_);
    shape_ = rest_;
    for (Eigen::Index u = 0; u < model_.units.cols(); ++u)
      for (Eigen::Index n = 0; n < shape_.cols(); ++n)
        shape_.col(n) += spread_(n, u) * output_.segment<3>(3 * u);
    estimate.X_OG[0] = grasp.X_OG;
  }
  const bool laid = model.restore(shape_, still_);
  estimate.step = elasticity::StepReport{
      laid ? elasticity::StepStatus::kConverged : elasticity::StepStatus::kFailed, 0, 0};
  estimate.log_young_modulus = std::log(model.body().material.young_modulus);
  estimate.poisson_ratio = model.body().material.poisson_ratio;
  if (!laid) return {Status::kDegraded, "the shape that was learned is not finite"};
  return result;
}

}  // namespace palpate::baselines
