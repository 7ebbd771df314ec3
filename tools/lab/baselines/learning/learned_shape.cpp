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
    : ShapePredictor(body), model_(model), average_(average) {
  model_.network.check();
  if (model_.units.cols() < 1 || !model_.units.allFinite() ||
      model_.network.outputs() != 3 * model_.units.cols() ||
      model_.network.inputs() != input_count(model_.inputs))
    throw std::invalid_argument("a learned shape's units, inputs and network do not agree");
  if (body.grasps.empty()) throw std::invalid_argument("a learned shape wants a hand that holds");
  if (!(average > 0)) throw std::invalid_argument("average of a learned shape must be positive");
  rest_pose_ = body.grasps[0].X_OG_rest;
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
  spread_.resize(rest().cols(), units);
  for (Eigen::Index n = 0; n < rest().cols(); ++n) {
    const Eigen::RowVectorXd squared =
        (model_.units.colwise() - rest().col(n)).colwise().squaredNorm();
    spread_.row(n) = (scale * (squared.array() - squared.minCoeff())).exp();
    spread_.row(n) /= spread_.row(n).sum();
  }
}

void LearnedShape::reset() noexcept {
  ShapePredictor::reset();
  force_.setZero();
  felt_ = false;
}

UpdateResult LearnedShape::predict(const estimation::EstimationInputs& inputs, double step,
                                   Eigen::Matrix3Xd& shape,
                                   estimation::Estimate& estimate) noexcept {
  const estimation::GraspInput& grasp = inputs.grasps[0];
  if (inputs.grasp_count < 1 || grasp.pose_freshness == Freshness::kNoData ||
      !grasp.X_OG.matrix().allFinite() || !grasp.wrench_valid || !grasp.F_G_O.force.allFinite())
    return {Status::kDegraded, "wrench or pose of the hand lacks"};
  const double share = felt_ ? 1 - std::exp(-step / average_) : 1;
  force_ += share * (grasp.F_G_O.force - force_);
  felt_ = true;
  gather(model_.inputs, force_, grasp.X_OG, rest_pose_, input_);
  model_.network.evaluate(input_, room_, output_);
  shape = rest();
  for (Eigen::Index u = 0; u < model_.units.cols(); ++u)
    for (Eigen::Index n = 0; n < shape.cols(); ++n)
      shape.col(n) += spread_(n, u) * output_.segment<3>(3 * u);
  estimate.X_OG[0] = grasp.X_OG;
  return {};
}

}  // namespace palpate::baselines
