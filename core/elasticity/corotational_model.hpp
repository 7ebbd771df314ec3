#pragma once

#include <Eigen/SparseCore>
#include <memory>

#include "core/elasticity/refactor_job.hpp"
#include "core/elasticity/secant_pairs.hpp"

namespace palpate::elasticity {

struct SolverOptions {
  int iterations = 2;       // quasi-Newton corrections per step at most, >= 1
  double tolerance = 1e-6;  // N, largest nodal force out of balance at which a step ends early
  int halvings = 4;         // of one correction, at most
  double time_step = 1e-3;  // s, of the factor that prepare() makes
  // When a new factor is asked for:
  double turned = 0.02;      // rad, an element has turned by that much since the snapshot
  double contraction = 0.3;  // a correction left more than this share of the residual
};

/// Energy-consistent co-rotated elasticity, solved incrementally: each step starts from the last
/// one's answer and makes a few quasi-Newton corrections with a factor that may be old but with the
/// nonlinear residual, so that what it converges to does not depend on the factor's age. A
/// correction that raises the potential is halved. Shared by the quasi-static and the dynamic
/// model, which minimise
///   E(x) - f.x   and   E(x) - f.x + |x - x*|^2_M inertia / 2 + viscous potential
/// over the free nodes.
class CorotationalModel : public DeformationModel {
 public:
  // The job refers to members.
  CorotationalModel(const CorotationalModel&) = delete;
  CorotationalModel& operator=(const CorotationalModel&) = delete;

  const Body& body() const noexcept override { return body_; }
  void prepare() override;
  void hold(int grasp, const math::Pose& X_OG) noexcept override;
  void release(int grasp) noexcept override;
  bool is_held(int grasp) const noexcept override { return grasps_[grasp].held; }
  void set_gravity(const Eigen::Vector3d& gravity_O) noexcept override { gravity_ = gravity_O; }
  Eigen::Matrix3Xd& loads() noexcept override { return loads_; }

  /// Fails, with the state as it was, until a factor for the present set of held grasps is
  /// installed.
  StepReport step(double dt) noexcept override;
  void reset() noexcept override;
  const Eigen::Matrix3Xd& positions() const noexcept override { return x_; }
  const Eigen::Matrix3Xd& velocities() const noexcept override { return v_; }
  math::Wrench reaction(int grasp) const noexcept override;
  const Sensitivity& sensitivity() const noexcept override { return sensitivity_; }
  Refactorisation* wanted_refactorisation() noexcept override;
  void install(Refactorisation& done) noexcept override;
  bool restore(const Eigen::Matrix3Xd& positions,
               const Eigen::Matrix3Xd& velocities) noexcept override;

  /// True while the factor in use was made of a matrix that had to be shifted: nothing holds the
  /// body in place, so that it has no unique equilibrium.
  bool is_regularised() const noexcept { return factor_.regularised; }

  const ElementSet& elements() const noexcept { return elements_; }

 protected:
  enum class Mechanics { kQuasistatic, kDynamic };
  CorotationalModel(Body body, const SolverOptions& options, Mechanics mechanics);

 private:
  struct Grasp {
    bool held = false;
    math::Pose target = math::Pose::Identity();
    math::Pose applied = math::Pose::Identity();  // that the present positions stand for
  };

  StepFactors step_factors(double dt) const noexcept;
  bool inputs_are_finite() const noexcept;
  void predict(double dt, bool follow) noexcept;
  double evaluate() noexcept;
  double residual() const noexcept;
  void correct(StepReport& report, double energy) noexcept;
  void learn() noexcept;
  void observe_turn() noexcept;

  Body body_;
  SolverOptions options_;
  bool dynamic_;
  ElementSet elements_;
  BlockPattern pattern_;
  Eigen::SparseMatrix<double, Eigen::RowMajor> mass_;  // n x n, kg; dynamic only

  std::array<Grasp, 2> grasps_;
  std::vector<char> held_;  // by unknown
  Eigen::Vector3d gravity_;
  Eigen::Matrix3Xd loads_, external_;
  Eigen::Matrix3Xd x_, v_, x_begin_, x_inertial_, x_trial_, dx_, forces_, forces_trial_;
  Eigen::Matrix4Xd rhs_, step_taken_, force_change_;  // by unknown
  SecantPairs secants_;
  StepFactors step_;
  ElementSet::State state_;

  LoopFactor factor_;
  RefactorJob job_;
  Sensitivity sensitivity_;
  double job_age_ = 0;  // s since the snapshot
  bool outstanding_ = false;
  bool wanted_ = false;
};

/// Static equilibrium under the present loads and hand poses, whatever the time step.
class CorotationalQuasistatic final : public CorotationalModel {
 public:
  explicit CorotationalQuasistatic(Body body, const SolverOptions& options = {})
      : CorotationalModel(std::move(body), options, Mechanics::kQuasistatic) {}
};

/// Backward Euler with consistent mass and Rayleigh damping.
class CorotationalDynamic final : public CorotationalModel {
 public:
  explicit CorotationalDynamic(Body body, const SolverOptions& options = {})
      : CorotationalModel(std::move(body), options, Mechanics::kDynamic) {}
};

}  // namespace palpate::elasticity
