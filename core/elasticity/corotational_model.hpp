#pragma once

#include <array>
#include <memory>
#include <optional>

#include "core/elasticity/body.hpp"
#include "core/elasticity/element_forces.hpp"
#include "core/elasticity/inertia.hpp"
#include "core/elasticity/refactor_job.hpp"
#include "core/elasticity/sensitivity.hpp"
#include "core/math/team.hpp"

namespace palpate::elasticity {

/// Smooth shape that satisfies the boundary conditions, without mechanics: each node moves with the
/// hands and the test rig, blended by the inverse squares of their distances at rest. A rigidly
/// moved body remains unstressed; no element is inverted if the motions of the hands are moderate.
class RigidBlend {
 public:
  explicit RigidBlend(const Body& body);

  /// Position of a node when held hands have moved by `motions` from rest.
  Eigen::Vector3d position(int node, const std::array<bool, 2>& held,
                           const std::array<math::Pose, 2>& motions) const noexcept;

 private:
  Eigen::Matrix3Xd rest_;
  /// m^2, squared distance of each node from patch 0, patch 1 and the fixed nodes
  Eigen::Matrix3Xd distance2_;
};

struct SolverOptions {
  int iterations = 2;       // maximum number of quasi-Newton corrections per step, >= 1
  double tolerance = 1e-6;  // N, largest unbalanced nodal force at which a step ends early
  double accuracy = 1e-7;   // m, a step also ends if the next correction would move no node by more
  // Whether forces are evaluated once more after a correction that is expected to end a step.
  // Without it a step costs one evaluation less; forces (including reactions) and energy are then
  // those before its last correction, and the reported residual is an estimate.
  bool confirm = true;
  // Number of sensitivity columns that a quasi-static step also corrects, in turn, each for the
  // cost of two evaluations and a solve. During a large motion, with factors 30 ms old, the error
  // of the columns is 6 % without correction, about 2 % if each is corrected in every step (6), 0.3
  // % if twice (12).
  int refine = 0;
  int halvings = 4;                          // maximum number of halvings of one correction
  double time_step = 1e-3;                   // s, time step of the factor that prepare() computes
  Precision precision = Precision::kDouble;  // arithmetic inside elements
  factor::PanelPrecision panels = factor::PanelPrecision::kSingle;  // storage of the factor
  // Conditions for requesting a new factor:
  double turned = 0.02;      // rad, largest rotation of a node since the snapshot
  double contraction = 0.3;  // fraction of the residual that remains after a correction
  // A step stops correcting after `budget` seconds of `clock` (s, monotonic), if set.
  double budget = 0;
  double (*clock)() = nullptr;
  // Threads that share the work of a step; without a team the calling thread alone. The team's size
  // determines the summation order and thus the last bits.
  std::shared_ptr<math::Team> team = nullptr;
};

/// Energy-consistent co-rotated elasticity, solved incrementally: each step starts from the
/// previous solution and makes a few quasi-Newton corrections with a possibly outdated factor but
/// with the nonlinear residual, so that the solution does not depend on the factor's age. The
/// factor is rotated with the nodes (NodeWarp) and improved by the last corrections (SecantPairs).
/// A correction that increases the potential is halved.
///
/// The energy has non-physical equilibria: with inverted elements or, after an excessive force,
/// twisted or folded without any. If a shape has inverted elements for a fifth of a second, or in a
/// tenth of the body at once, or had some and is now at rest under strain for that long, it is
/// compared with the shape that RigidBlend constructs from the boundary conditions, and is replaced
/// by it if that has the lower potential (StepReport::restarted). Each restart lowers the
/// potential, so that none recurs without new loads or poses. A shape without inverted elements in
/// its past is never replaced, because a hand may well have twisted it.
///
/// Base of the quasi-static and the dynamic model, which minimise
///   E(x) - f.x   and   E(x) - f.x + |x - x*|^2_M inertia / 2 + viscous potential
/// over the free nodes. Internally, nodes are in elimination order, fixed ones last.
class CorotationalModel : public DeformationModel {
 public:
  // the job refers to members
  CorotationalModel(const CorotationalModel&) = delete;
  CorotationalModel& operator=(const CorotationalModel&) = delete;

  const Body& body() const noexcept override { return body_; }
  void prepare() override;
  void hold(int grasp, const math::Pose& X_OG) noexcept override;
  void release(int grasp) noexcept override;
  bool is_held(int grasp) const noexcept override { return held_[grasp]; }
  void set_gravity(const Eigen::Vector3d& gravity_O) noexcept override { gravity_ = gravity_O; }
  Eigen::Matrix3Xd& loads() noexcept override { return loads_; }

  /// Grasps held or released take effect from the next step on. Fails, with the state unchanged, if
  /// the factor cannot serve them (the object would be unsupported) until a new one is installed.
  StepReport step(double dt) noexcept override;
  void reset() noexcept override;
  const Eigen::Matrix3Xd& positions() const noexcept override { return positions_; }
  const Eigen::Matrix3Xd& velocities() const noexcept override { return velocities_; }
  math::Wrench reaction(int grasp) const noexcept override;
  const Sensitivity& sensitivity() const noexcept override { return sensitivity_; }
  void watch_contact(int slot, const mesh::PointWeights& point) noexcept override;
  Refactorisation* wanted_refactorisation() noexcept override;
  void install(Refactorisation& done) noexcept override;
  bool restore(const Eigen::Matrix3Xd& positions,
               const Eigen::Matrix3Xd& velocities) noexcept override;

  /// True while the factor in use was computed from a shifted matrix: the body is unsupported and
  /// has no unique equilibrium.
  bool is_regularised() const noexcept { return factor_.regularised; }

  const ElementSet& elements() const noexcept { return elements_; }
  double factor_age() const noexcept { return factor_age_; }  // s since its snapshot

 protected:
  enum class Mechanics { kQuasistatic, kDynamic };
  CorotationalModel(Body body, const SolverOptions& options, Mechanics mechanics);

 private:
  static constexpr double kFar = 1e9;       // m
  static constexpr int kTanglePeriod = 16;  // steps between checks for inverted elements

  struct Grasp {
    math::Pose target = math::Pose::Identity();
    math::Pose applied = math::Pose::Identity();   // pose applied to the present positions
    math::Pose snapshot = math::Pose::Identity();  // pose at which the sensitivity was computed
  };

  math::Team& team() const noexcept {
    return options_.team != nullptr ? *options_.team : math::solo_team;
  }
  StepFactors step_factors(double dt) const noexcept;
  bool inputs_are_finite() const noexcept;
  bool is_last_correction(double size, int iteration) const noexcept;
  bool out_of_time(double start) const noexcept;
  void predict(double dt, bool follow) noexcept;
  double evaluate() noexcept;
  double residual() const noexcept;
  double find_correction() noexcept;
  double slope() const noexcept;
  void add_correction(const NodalField& from, double share) noexcept;
  void correct(StepReport& report, double& energy, double start) noexcept;
  double potential_of_staying() const noexcept;
  void remember_surprise() noexcept;
  void stay_if_better(StepReport& report, double& energy, double dt, double start) noexcept;
  void learn() noexcept;
  void follow_rotations() noexcept;
  bool recover_inverted_elements(StepReport& report) noexcept;
  void detect_inversion(const StepReport& report) noexcept;
  double static_potential() noexcept;
  void turn_sensitivity(int begin, int end) noexcept;
  void refine_column() noexcept;
  void set_column(int g, int k) noexcept;
  void solve_for(Eigen::VectorXf& b) noexcept;
  void publish() noexcept;

  Body body_;
  SolverOptions options_;
  bool dynamic_;
  ElementSet elements_;
  factor::BlockPattern pattern_;
  factor::Supernodes supernodes_;
  std::vector<int> numbering_;  // column of each mesh node in nodal fields
  std::unique_ptr<ElementForces> element_forces_;
  std::optional<Inertia> inertia_;  // dynamic only
  double rounding_;                 // relative rounding error of the energy

  factor::Held held_{false, false};
  std::array<Grasp, 2> grasps_;
  std::array<mesh::PointWeights, kContactSlots> contacts_;
  Eigen::Vector3d gravity_;
  Eigen::Matrix3Xd loads_, positions_, velocities_;  // in mesh order
  NodalField weight_per_gravity_, rest_;
  NodalField external_, x_, v_, prediction_error_, x_begin_, x_inertial_, x_expected_, x_trial_,
      x_kept_, forces_, forces_trial_;
  Eigen::VectorXf correction_, step_taken_, force_change_;  // three per node, unknown nodes only
  SecantPairs secants_;
  StepFactors step_;
  double dt_ = 0;
  /// Fraction of a step's prediction error that recurs in the next one, 0 to 1.
  double persistence_ = 0;
  double reach_ = kFar;  // m, initial limit of a correction's nodal displacement
  /// Ratio of a step's second correction to its first, at the last measurement.
  double contraction_ = 1;
  /// J, energy of the elements: last evaluated, and at the beginning of the step
  double elastic_ = 0, elastic_begin_ = 0;

  Eigen::Matrix4Xf rotations_;  // node rotations at the last check
  NodeWarp warp_;
  LoopFactor factor_;
  double factor_age_ = 0;
  RefactorJob job_;
  std::array<math::Pose, 2> job_grasps_;
  double job_age_ = 0;                     // s since the job's snapshot
  Sensitivity sensitivity_, at_snapshot_;  // as published, and as computed
  std::optional<TangentProduct> tangent_;
  NodalField column_;  // column under refinement
  int refined_ = 0;    // 6 grasp + motion, the column refined last
  RigidBlend blend_;
  int ticks_ = 0;
  int suspect_count_ = 0;       // consecutive checks with a suspect shape
  bool inverted_ = false;       // inverted elements at the last check
  bool torn_ = false;           // elements were inverted, and strains have not been small since
  double elastic_at_look_ = 0;  // J, including the viscous potential
  bool outstanding_ = false;
  bool wanted_ = false;
};

/// Static equilibrium under the present loads and hand poses, independent of the time step.
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
