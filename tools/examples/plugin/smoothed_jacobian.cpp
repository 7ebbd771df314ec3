#include "smoothed_jacobian.hpp"

#include <stdexcept>

#include "core/control/jacobian_providers.hpp"

namespace example {

palpate::config::OptionTable<SmoothedJacobian::Options> SmoothedJacobian::table() {
  return palpate::config::OptionTable<Options>().number("time_constant_ms", "ms",
                                                        "time constant of the smoothing",
                                                        {0, 10000}, &Options::time_constant, 1e-3);
}

SmoothedJacobian::SmoothedJacobian(const Options& options, const palpate::plugin::PluginCell& cell)
    : share_(cell.period / (options.time_constant + cell.period)), grasp_(cell.moved_grasp) {
  if (cell.moved_grasps != 1) throw std::invalid_argument("moves one hand only");
}

bool SmoothedJacobian::update(const palpate::shape::Feature& feature,
                              const palpate::elasticity::DeformationModel& model,
                              const palpate::math::Pose& /*X_OG*/, Eigen::Ref<Eigen::MatrixXd> J) {
  const palpate::elasticity::Sensitivity& sensitivity = model.sensitivity();
  if (!sensitivity.valid || !model.is_held(grasp_)) return false;
  const auto motion_of = [&](int node) {
    return sensitivity.dx_dxi[grasp_].middleRows<3>(3 * node);
  };
  palpate::control::accumulate_support(feature, motion_of, J);
  if (smoothed_.rows() == 0) smoothed_ = J;
  smoothed_ += share_ * (J - smoothed_);
  J = smoothed_;
  return true;
}

}  // namespace example
