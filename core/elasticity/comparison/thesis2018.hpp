#pragma once

#include "core/elasticity/body_system.hpp"
#include "core/elasticity/comparison/comparison_model.hpp"

namespace palpate::elasticity {

/// Integrator of the thesis software of 2018 (Sanchez 2019; Vega FEM's co-rotational tetrahedra,
/// "warp 1"), to reproduce its results: linear tetrahedra, warped stiffness R K R^T, consistent
/// mass, Rayleigh damping, implicit Euler with one Newton step,
///   (M + h D + h^2 K) dv = h [f_ext - f_int - (D + h K) v],  v += dv,  x += h v.
/// As in the original, every call of step() advances by kTimeStep whatever dt, so that simulated
/// time differs from real time. It factors in every step.
class Thesis2018 final : public ComparisonModel {
 public:
  /// Throws std::invalid_argument for a quadratic mesh.
  explicit Thesis2018(Body body);

  static constexpr double kTimeStep = 0.02;  // s

  void reset() noexcept override;

 private:
  /// The residual is not evaluated after the single Newton step and is reported as zero.
  StepReport advance(double dt) noexcept override;
  void assemble() noexcept;

  BodySystem system_;
  Eigen::Matrix3Xd impulse_, dv_, product_;
  Eigen::MatrixXd rhs_, element_matrix_, element_mass_;
};

}  // namespace palpate::elasticity
