#pragma once

#include <gtest/gtest.h>

#include "core/control/jacobian_providers.hpp"
#include "core/control/quadratic_program.hpp"
#include "core/elasticity/corotational_model.hpp"
#include "core/shape/point_features.hpp"
#include "tests/unit/core/estimation/rigid_model.hpp"

namespace palpate::control {

inline TwistLawOptions servo() {
  TwistLawOptions options;
  options.gain = 2;
  options.linear_speed = 0.1;
  options.angular_speed = 0.5;
  options.dead_band = {1e-4, 1e-3, 1.2};
  return options;
}

/// The law on a bar that bends, whose model is both plant and estimate: the hand at its end
/// controls the middle of the bar's upper side.
class BarServo : public ::testing::Test {
 protected:
  void start(ControlLaw& law, const Eigen::Vector3d& target_offset) {
    body_ = support::held_bar({8, 1, 1}, mesh::ElementOrder::kQuadratic);
    body_.gravity_O.setZero();
    model_ = std::make_unique<elasticity::CorotationalQuasistatic>(body_, options_);
    model_->prepare();
    feature_ = std::make_unique<shape::PointFeature>(
        body_.mesh, shape::PointFeature::Options{{Eigen::Vector3d(0.25, 0.03, 0.06)}});
    law_ = &law;
    law.configure_for(*feature_);
    value_.setZero(3);
    error_.setZero(3);
    output_.unreachable.setZero(3);
    jacobian_.setZero(3, 6);
    X_OG_ = body_.grasps[0].X_OG_rest;
    step();
    target_ = value_ + target_offset;
  }

  void step() {
    model_->hold(0, X_OG_);
    if (elasticity::Refactorisation* job = model_->wanted_refactorisation()) {
      job->run();
      model_->install(*job);
    }
    for (int i = 0; i < 3; ++i) model_->step(1e-3);
    feature_->evaluate(model_->positions(), value_);
  }

  LawInputs inputs() {
    LawInputs inputs;
    inputs.dt = kPeriod;
    inputs.value = &value_;
    inputs.target = &target_;
    inputs.error = &error_;
    inputs.jacobian = &jacobian_;
    inputs.model = model_.get();
    inputs.X_OG[0] = X_OG_;
    inputs.reaction[0] = model_->reaction(0);
    if (!placements_.empty()) inputs.obstacles = &placements_;
    if (!node_deviation_.empty()) inputs.node_deviation = &node_deviation_;
    return inputs;
  }

  /// True if a Jacobian was available to the law.
  bool tick() {
    feature_->error(value_, target_, error_);
    if (!provider_.update(*feature_, *model_, X_OG_, jacobian_)) return false;
    law_->compute(inputs(), output_);
    X_OG_.translation() += kPeriod * output_.V_O_G.linear;
    X_OG_.linear() = math::exp_rotation(kPeriod * output_.V_O_G.angular) * X_OG_.linear();
    step();
    return true;
  }
  double error() const { return (target_ - value_).norm(); }

  static constexpr double kPeriod = 5e-3;  // s
  elasticity::Body body_;
  elasticity::SolverOptions options_;
  std::unique_ptr<elasticity::CorotationalQuasistatic> model_;
  std::unique_ptr<shape::PointFeature> feature_;
  FemJacobian provider_{FemJacobian::Options{}};
  ControlLaw* law_ = nullptr;
  Eigen::VectorXd value_, target_, error_;
  Eigen::MatrixXd jacobian_;
  LawOutput output_;
  math::Pose X_OG_;
  std::vector<collision::Placement> placements_;  // of obstacles; empty: as in the limits
  std::vector<float> node_deviation_;             // m; empty: not provided
};

}  // namespace palpate::control
