#pragma once

#include <array>

#include "rt/plugin/plugin.hpp"

namespace example {

/// Example of a user's estimator: the grasps of the model follow the low-pass filtered poses of the
/// hands, and contacts load it.
class SmoothedHand : public palpate::plugin::PluginEstimator {
 public:
  struct Options {
    double time_constant = 0.02;  // s
    double max_age = 0.05;        // s without a new pose until the estimate counts as old
  };
  static palpate::config::OptionTable<Options> table();

  explicit SmoothedHand(const Options& options) : options_(options) {}

  void activate(palpate::elasticity::DeformationModel& model) override;
  palpate::UpdateResult update(const palpate::estimation::EstimationInputs& inputs,
                               palpate::elasticity::DeformationModel& model,
                               palpate::estimation::Estimate& estimate) override;
  void reset() override { ages_.fill(0); }
  void take_over(const palpate::estimation::Estimate& last,
                 palpate::elasticity::DeformationModel& model) override;

 private:
  Options options_;
  std::array<palpate::math::Pose, 2> poses_{palpate::math::Pose::Identity(),
                                            palpate::math::Pose::Identity()};  // in O
  std::array<double, 2> ages_{};  // s, of the hands' latest poses
};

}  // namespace example
