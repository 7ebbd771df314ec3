#pragma once

#include <memory>
#include <optional>

#include "core/elasticity/element_forces.hpp"
#include "core/elasticity/inertia.hpp"
#include "core/elasticity/node_warp.hpp"
#include "core/elasticity/refactor_job.hpp"
#include "core/elasticity/rigid_blend.hpp"
#include "core/elasticity/secant_pairs.hpp"
#include "core/elasticity/tangent_product.hpp"
#include "core/math/team.hpp"

namespace palpate::elasticity {

struct SolverOptions {
  int iterations = 2;       // quasi-Newton corrections per step at most, >= 1
  double tolerance = 1e-6;  // N, largest nodal force out of balance at which a step ends early
  double accuracy =
      1e-7;  // m, a step also ends where the next correction would move no node further
  // Whether forces are evaluated once more after a correction that is expected to end a step.
  // Without that, a step costs one evaluation less, forces (reactions among them) and energy are
  // those before its last correction, and the residual that it reports is an estimate.
  bool confirm = true;
  // Motion columns of the sensitivity that a quasi-static step also corrects, in turn, each for the
  // price of two evaluations and a solve. Under a large motion, with factors 30 ms old, columns are
  // 6 % off without, some 2 % if each is corrected in every step (6), 0.3 % if twice (12).
  int refine = 0;
  int halvings = 4;                          // of one correction, at most
  double time_step = 1e-3;                   // s, of the factor that prepare() makes
  Precision precision = Precision::kDouble;  // of the arithmetic inside elements
  factor::PanelPrecision panels = factor::PanelPrecision::kSingle;  // of the factor
  // When a new factor is asked for:
  double turned = 0.02;      // rad, a node has turned by that much since the snapshot
  double contraction = 0.3;  // a correction left more than this share of the residual
  // A step stops correcting after `budget` seconds of `clock` (s, monotonic), where it is given.
  double budget = 0;
  double (*clock)() = nullptr;
  // Shares a step's work; without one it is the calling thread's alone. Its size, but nothing else
  // of it, decides the order of sums and so the last bits.
  std::shared_ptr<math::Team> team = nullptr;
};

/// Energy-consistent co-rotated elasticity, solved incrementally: each step starts from the last
/// one's answer and makes a few quasi-Newton corrections with a factor that may be old but with the
/// nonlinear residual, so that what it converges to does not depend on the factor's age. The factor
/// is turned with the nodes (NodeWarp) and sharpened by the last corrections (SecantPairs). A
/// correction that raises the potential is halved.
///
/// The energy has equilibria that no body has: with elements inside out, or, left behind by a force
/// far too large, twisted or folded without any. A shape that has elements inside out for a fifth
/// of a second, or a tenth of all at once, or that had some and now stands still under strain for
/// so long, is compared with the one that RigidBlend makes of the boundary, and given up for it
/// where that has the lower potential (StepReport::restarted). Every such start descends, so that
/// none is repeated without new loads or poses. A shape without such a past is never doubted: a
/// hand may well have twisted it. Shared by the quasi-static and the dynamic model, which minimise
///   E(x) - f.x   and   E(x) - f.x + |x - x*|^2_M inertia / 2 + viscous potential
/// over the free nodes. Inside, nodes stand in the order of elimination, fixed ones last.
class CorotationalModel : public DeformationModel {
 public:
  // The job refers to members.
  CorotationalModel(const CorotationalModel&) = delete;
  CorotationalModel& operator=(const CorotationalModel&) = delete;

  const Body& body() const noexcept override { return body_; }
  void prepare() override;
  void hold(int grasp, const math::Pose& X_OG) noexcept override;
  void release(int grasp) noexcept override;
  bool is_held(int grasp) const noexcept override { return held_[grasp]; }
  void set_gravity(const Eigen::Vector3d& gravity_O) noexcept override { gravity_ = gravity_O; }
  Eigen::Matrix3Xd& loads() noexcept override { return loads_; }

  /// Grasps made and released count from the next step on. Fails, with the state as it was, where
  /// the factor cannot serve them (nothing would hold the object) until a new one is installed.
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

  /// True while the factor in use was made of a matrix that had to be shifted: nothing holds the
  /// body in place, so that it has no unique equilibrium.
  bool is_regularised() const noexcept { return factor_.regularised; }

  const ElementSet& elements() const noexcept { return elements_; }
  double factor_age() const noexcept { return factor_age_; }  // s since its snapshot

 protected:
  enum class Mechanics { kQuasistatic, kDynamic };
  CorotationalModel(Body body, const SolverOptions& options, Mechanics mechanics);

 private:
  static constexpr double kFar = 1e9;       // m
  static constexpr int kTanglePeriod = 16;  // steps between looks for inside-out elements

  struct Grasp {
    math::Pose target = math::Pose::Identity();
    math::Pose applied = math::Pose::Identity();   // that the present positions stand for
    math::Pose snapshot = math::Pose::Identity();  // that the sensitivity was computed at
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
  bool untangle(StepReport& report) noexcept;
  void look_for_tears(const StepReport& report) noexcept;
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
  std::vector<int> numbering_;  // of mesh nodes in nodal fields
  std::unique_ptr<ElementForces> element_forces_;
  std::optional<Inertia> inertia_;  // dynamic only
  double rounding_;                 // relative, of the energy

  factor::Held held_{false, false};
  std::array<Grasp, 2> grasps_;
  std::array<mesh::PointWeights, kContactSlots> contacts_;
  Eigen::Vector3d gravity_;
  Eigen::Matrix3Xd loads_, positions_, velocities_;  // in the order of the mesh
  NodalField weight_per_gravity_, rest_;
  NodalField external_, x_, v_, surprise_, x_begin_, x_inertial_, x_expected_, x_trial_, x_kept_,
      forces_, forces_trial_;
  Eigen::VectorXf correction_, step_taken_, force_change_;  // three a node, unknown nodes only
  SecantPairs secants_;
  StepFactors step_;
  double dt_ = 0;
  double persistence_ = 0;  // share of a step's surprise that the next one repeats, 0 to 1
  double reach_ = kFar;     // m, that a correction may move a node at first
  double contraction_ = 1;  // of a step's second correction against its first, last time
  double elastic_ = 0, elastic_begin_ = 0;  // J, of elements: last evaluated, and as the step began

  Eigen::Matrix4Xf rotations_;  // of nodes, at the last look
  NodeWarp warp_;
  LoopFactor factor_;
  double factor_age_ = 0;
  RefactorJob job_;
  std::array<math::Pose, 2> job_grasps_;
  double job_age_ = 0;                     // s since the snapshot
  Sensitivity sensitivity_, at_snapshot_;  // as published, and as computed
  std::optional<TangentProduct> tangent_;
  NodalField column_;  // that is refined
  int refined_ = 0;    // 6 grasp + motion, the one refined last
  RigidBlend blend_;
  int ticks_ = 0;
  int doubtful_ = 0;            // looks in a row that found the shape a doubtful one
  bool inverted_ = false;       // elements at the last look
  bool torn_ = false;           // some were inverted, and strains have not been small since
  double elastic_at_look_ = 0;  // J, with viscous potential
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
