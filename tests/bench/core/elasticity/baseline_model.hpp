#pragma once

#include <optional>

#include "core/math/rigid.hpp"
#include "tests/bench/core/elasticity/cholmod_solver.hpp"
#include "tests/bench/core/elasticity/jacobi_pcg.hpp"

namespace palpate::bench {

/// Cost of a step without an incremental solver: tangent assembled in each step and one Newton
/// step, its linear system solved by a full factorisation or by Jacobi-PCG to 1e-3. The same
/// equations as the model under test, so that both agree to the residual of one Newton step.
class BaselineModel {
 public:
  enum class Solver { kCholmod, kJacobiPcg };
  static constexpr double kPcgTolerance = 1e-3;

  BaselineModel(const elasticity::Body& body, Solver solver, bool dynamic);

  /// State before a step. Computes the rotations of that state, as a model that had arrived there
  /// would have them.
  void restore(const Eigen::Matrix3Xd& x, const Eigen::Matrix3Xd& v);

  /// False if the tangent is not positive definite.
  bool step(double dt, const math::Pose& clamp, const Eigen::Matrix3Xd& loads);

  /// The same step by Newton's method until no nodal residual force exceeds `tolerance` (N); false
  /// if it does not converge.
  bool converge(double dt, const math::Pose& clamp, const Eigen::Matrix3Xd& loads,
                double tolerance);

  const Eigen::Matrix3Xd& positions() const { return x_; }
  const Eigen::Matrix3Xd& velocities() const { return v_; }
  int iterations() const { return iterations_; }              // of the last solve
  double assembly_seconds() const { return assembly_time_; }  // of the last step, thread time
  const BaselineSystem& system() const { return system_; }

 private:
  void predict(double dt, const math::Pose& clamp);
  bool correct();

  const elasticity::Body body_;
  bool dynamic_;
  BaselineSystem system_;
  std::optional<CholmodSolver> cholmod_;
  std::optional<JacobiPcg> pcg_;
  Eigen::Matrix3Xd x_, v_, x_begin_, x_inertial_, no_loads_;
  Eigen::Matrix4Xd dx_;
  double inertia_ = 0;  // 1/s^2
  int iterations_ = 0;
  double assembly_time_ = 0;
};

}  // namespace palpate::bench
