#pragma once

#include "core/control/control_law.hpp"
#include "core/elasticity/static_solver.hpp"
#include "tests/unit/core/estimation/rigid_model.hpp"

namespace palpate::support {

/// A bar in static equilibrium under a hand that follows its commands: the controlled plant.
class HeldBarPlant {
 public:
  explicit HeldBarPlant(elasticity::Body body)
      : body_(std::move(body)), solver_(body_), X_OG_(body_.grasps[0].X_OG_rest) {
    settle();
  }

  void move(const math::Twist& V, double dt) {
    X_OG_.translation() += dt * V.linear;
    X_OG_.linear() = math::exp_rotation(dt * V.angular) * X_OG_.linear();
    settle();
  }
  void place(const math::Pose& X_OG) {
    X_OG_ = X_OG;
    settle();
  }

  const elasticity::Body& body() const { return body_; }
  const math::Pose& X_OG() const { return X_OG_; }
  const Eigen::Matrix3Xd& positions() const { return positions_; }
  math::Wrench wrench() const { return wrench_; }
  elasticity::Sensitivity response() { return solver_.response(); }

  /// Current value of the feature.
  Eigen::VectorXd value(shape::Feature& feature) const {
    Eigen::VectorXd value(feature.value_count());
    feature.evaluate(positions_, value);
    return value;
  }

 private:
  void settle() {
    elasticity::HeldPoses held;
    held[0] = X_OG_;
    const Eigen::Matrix3Xd none = Eigen::Matrix3Xd::Zero(3, body_.mesh.node_count());
    const elasticity::StaticSolution solution =
        solver_.solve(none, held, {}, positions_.cols() > 0 ? &positions_ : nullptr);
    if (!solution.converged) throw std::runtime_error("the plant has no equilibrium");
    positions_ = solution.positions;
    wrench_ = elasticity::patch_wrench(body_.grasps[0], X_OG_, positions_, solution.reactions);
  }

  elasticity::Body body_;
  elasticity::StaticSolver solver_;
  math::Pose X_OG_;
  Eigen::Matrix3Xd positions_;
  math::Wrench wrench_;
};

inline elasticity::Body weightless_bar() {
  elasticity::Body body = held_bar({6, 1, 1}, mesh::ElementOrder::kLinear);
  body.gravity_O.setZero();
  return body;
}

/// Inputs of a provider about the feature.
inline control::Experience seen(const HeldBarPlant& plant, const Eigen::VectorXd& value,
                                double dt) {
  control::Experience now;
  now.dt = dt;
  now.value = &value;
  now.positions = &plant.positions();
  now.X_OG = plant.X_OG();
  now.wrench_valid = true;
  now.F_G_O = plant.wrench();
  return now;
}

}  // namespace palpate::support
