#pragma once

#include <array>
#include <vector>

#include "rt/plugin/plugin.hpp"

namespace example {

/// Example of a user's deformation model, without mechanics: every node follows the rigid motion of
/// the first grasp by a share that grows from 0 at the fixed nodes to 1 at the grasped ones with
/// the ratio of its distances from both. The shape at rest is kept without a hand; there are no
/// reactions, and loads have no effect.
class BlendedModel : public palpate::plugin::PluginDeformationModel {
 public:
  struct Options {
    double power = 1;  // of the share: 2 bends the object near the grasp
  };
  static palpate::config::OptionTable<Options> table();

  /// Throws std::invalid_argument if the object is not fixed and held.
  BlendedModel(const Options& options, const palpate::elasticity::Body& body);

  void prepare() override;
  void hold(int grasp, const palpate::math::Pose& X_OG) override;
  void release(int grasp) override;
  void set_gravity(const Eigen::Vector3d&) override {}
  palpate::elasticity::StepReport step(double dt, const Eigen::Matrix3Xd& loads, Nodes positions,
                                       Nodes velocities) override;
  void reset() override { held_ = false; }
  palpate::math::Wrench reaction(int) const override { return {}; }
  const palpate::elasticity::Sensitivity* sensitivity() const override { return &sensitivity_; }

 private:
  void differentiate(const Nodes& positions);

  Options options_;
  const palpate::elasticity::Body& body_;
  std::vector<double> shares_;
  bool held_ = false;
  palpate::math::Pose X_OG_ = palpate::math::Pose::Identity();
  palpate::elasticity::Sensitivity sensitivity_;
};

}  // namespace example
