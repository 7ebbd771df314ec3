#pragma once

#include <memory>
#include <optional>

#include "core/elasticity/incremental/column_refinement.hpp"
#include "core/elasticity/incremental/inversion_recovery.hpp"
#include "core/elasticity/incremental/nodal_motion.hpp"
#include "core/elasticity/incremental/quasi_newton.hpp"
#include "core/elasticity/incremental/refactor_job.hpp"

namespace palpate::elasticity {

/// Energy-consistent elasticity in axes that rotate with each point, with the linear law or
/// Body::law, solved incrementally: each step starts from the
/// previous solution and makes a few quasi-Newton corrections with a possibly outdated factor but
/// with the nonlinear residual, so that the solution does not depend on the factor's age. Shapes
/// that are not physical are replaced if they last for a fifth of a second, or at once if a tenth
/// of the body is inverted (InversionRecovery, StepReport::restarted).
///
/// Base of the quasi-static and the dynamic model. A step: NodalMotion predicts from velocities or
/// TrackedSensitivity, StepPotential evaluates energy and forces, QuasiNewton corrects with the
/// WarpedFactor; now and then RefactorJob computes a new factor and sensitivity elsewhere.
class CorotationalModel : public DeformationModel {
 public:
  // members refer to each other
  CorotationalModel(const CorotationalModel&) = delete;
  CorotationalModel& operator=(const CorotationalModel&) = delete;

  const Body& body() const noexcept override { return body_.body; }
  void prepare() override;
  void hold(int grasp, const math::Pose& X_OG) noexcept override;
  /// Where the present factor cannot serve the body without the grasp (it would be unsupported),
  /// the grasp remains held, where the hand last was, until a factor of the free body is installed.
  void release(int grasp) noexcept override;
  bool is_held(int grasp) const noexcept override { return boundary_.held()[grasp]; }
  void set_gravity(const Eigen::Vector3d& gravity_O) noexcept override {
    boundary_.set_gravity(gravity_O);
  }
  Eigen::Matrix3Xd& loads() noexcept override { return boundary_.loads(); }

  /// Fails, with the state unchanged, if no factor serves the held grasps, or if a load, a pose or
  /// the time step is not finite.
  StepReport step(double dt) noexcept override;
  void reset() noexcept override;
  const Eigen::Matrix3Xd& positions() const noexcept override { return motion_.positions(); }
  const Eigen::Matrix3Xd& velocities() const noexcept override { return motion_.velocities(); }
  math::Wrench reaction(int grasp) const noexcept override;
  const Sensitivity& sensitivity() const noexcept override { return sensitivity_.published(); }
  void watch_contact(int slot, const mesh::PointWeights& point) noexcept override;
  Refactorisation* wanted_refactorisation() noexcept override;
  void install(Refactorisation& done) noexcept override;
  bool restore(const Eigen::Matrix3Xd& positions,
               const Eigen::Matrix3Xd& velocities) noexcept override;

  /// True while the factor in use was computed from a shifted matrix: the body is unsupported and
  /// has no unique equilibrium.
  bool is_regularised() const noexcept { return factor_.is_regularised(); }

  void place_obstacle(int index, const collision::Placement& placement) noexcept override;
  const std::vector<SurfaceContact>& contacts() const noexcept override;

  const ElementSet& elements() const noexcept { return body_.elements; }
  double factor_age() const noexcept { return factor_.age(); }  // s since its snapshot

 protected:
  enum class Mechanics { kQuasistatic, kDynamic };
  CorotationalModel(Body body, const SolverOptions& options, Mechanics mechanics);

 private:
  void predict(double dt, bool follow) noexcept;
  bool is_prediction_plausible() const noexcept;
  double evaluate_prediction(double dt) noexcept;
  void recover_inverted_elements(StepReport& report, double& energy) noexcept;
  void stay_if_better(StepReport& report, double& energy, double dt,
                      const StepBudget& budget) noexcept;
  void grasps_have_changed() noexcept;
  factor::Held held_after_releases() const noexcept;
  void complete_releases() noexcept;

  SolverOptions options_;
  bool dynamic_;
  NumberedBody body_;
  BoundaryConditions boundary_;
  factor::Held releasing_{false, false};     // held until a factor serves the body without them
  std::vector<mesh::PointWeights> samples_;  // of the surface, for contact; solver's numbering
  NodalMotion motion_;
  StepPotential potential_;
  WarpedFactor factor_;
  std::unique_ptr<ObstacleContacts> contacts_;  // with obstacles only
  QuasiNewton corrections_;
  InversionRecovery recovery_;
  TrackedSensitivity sensitivity_;
  std::optional<ColumnRefinement> refinement_;
  NodalField x_corrected_;  // m, kept while an alternative is tried
  int ticks_ = 0;           // valid steps
  RefactorJob job_;
  double job_age_ = 0;        // s since the job's snapshot
  bool outstanding_ = false;  // the job has been handed out
};

/// Static equilibrium under the present loads and hand poses, independent of the time step:
/// minimises E(x) - f.x over the free nodes.
class CorotationalQuasistatic final : public CorotationalModel {
 public:
  explicit CorotationalQuasistatic(Body body, const SolverOptions& options = {})
      : CorotationalModel(std::move(body), options, Mechanics::kQuasistatic) {}
};

/// Backward Euler with consistent mass and Rayleigh damping, as the minimum of StepPotential.
class CorotationalDynamic final : public CorotationalModel {
 public:
  explicit CorotationalDynamic(Body body, const SolverOptions& options = {})
      : CorotationalModel(std::move(body), options, Mechanics::kDynamic) {}
};

}  // namespace palpate::elasticity
