#pragma once

#include "rt/plugin/plugin.hpp"

namespace example {

/// Example of a user's Jacobian provider: the Jacobian of the mechanics, as of the built-in
/// provider fem, smoothed in time, so that a law does not follow every change of the estimated
/// shape. For one hand that moves.
class SmoothedJacobian : public palpate::plugin::PluginJacobianProvider {
 public:
  struct Options {
    double time_constant = 0.1;  // s
  };
  /// The keys of the configuration.
  static palpate::config::OptionTable<Options> table();

  /// Throws std::invalid_argument if two hands move.
  SmoothedJacobian(const Options& options, const palpate::plugin::PluginCell& cell);

  /// False while the model has no sensitivity or the hand does not hold the object.
  bool update(const palpate::shape::Feature& feature,
              const palpate::elasticity::DeformationModel& model, const palpate::math::Pose& X_OG,
              Eigen::Ref<Eigen::MatrixXd> J) override;
  void reset() override { smoothed_.resize(0, 6); }

 private:
  double share_;  // of the present Jacobian, in each cycle
  int grasp_;
  /// Empty: none yet. Of bounded size, to avoid any heap allocation.
  Eigen::Matrix<double, Eigen::Dynamic, 6, 0, 32, 6> smoothed_;
};

}  // namespace example
