#pragma once

#include <array>

#include "core/elasticity/incremental/boundary_conditions.hpp"
#include "core/elasticity/incremental/loop_factor.hpp"
#include "core/elasticity/incremental/solver_options.hpp"
#include "core/elasticity/sensitivity.hpp"

namespace palpate::elasticity {

/// Limited-memory quasi-Newton update: pairs of a correction and the resulting change of force
/// improve a slightly outdated factor (L-BFGS, Nocedal 1980, with that factor as initial matrix).
/// The length of the vectors is the number of unknown coordinates.
class SecantPairs {
 public:
  explicit SecantPairs(int size);

  void clear() noexcept { count_ = 0; }

  /// Stores the pair in place of the oldest; rejects one without positive curvature.
  void add(const Eigen::VectorXf& step, const Eigen::VectorXf& change) noexcept;

  /// Overwrites b with an improved solution of A x = b; `solve(b)` applies the factor.
  template <class Solve>
  void apply(Eigen::VectorXf& b, const Solve& solve) noexcept {
    std::array<float, kPairs> a;
    for (int k = 0; k < count_; ++k) {
      const Pair& pair = newest(k);
      a[k] = pair.scale * dot(pair.step, b);
      b -= a[k] * pair.change;
    }
    solve(b);
    for (int k = count_ - 1; k >= 0; --k) {
      const Pair& pair = newest(k);
      b += (a[k] - pair.scale * dot(pair.change, b)) * pair.step;
    }
  }

 private:
  static constexpr int kPairs = 6;
  struct Pair {
    Eigen::VectorXf step, change;
    float scale = 0;  // 1 / step . change
  };
  static float dot(const Eigen::VectorXf& a, const Eigen::VectorXf& b) noexcept { return a.dot(b); }
  const Pair& newest(int k) const noexcept { return pairs_[(next_ + kPairs - 1 - k) % kPairs]; }

  std::array<Pair, kPairs> pairs_;
  int next_ = 0;
  int count_ = 0;
};

/// Approximate inverse of the present tangent: the factor of a recent snapshot, rotated with the
/// nodes since (NodeWarp) and improved by the last corrections (SecantPairs). Keeps whether a new
/// factor is wanted.
class WarpedFactor {
 public:
  /// All must outlive this object. `samples`: of LoopFactor.
  WarpedFactor(const NumberedBody& body, const SolverOptions& options,
               const std::vector<mesh::PointWeights>& samples);

  /// Overwrites `b` (three coordinates per unknown node) with the approximate solution; held nodes
  /// get zero.
  void solve(Eigen::VectorXf& b, const BoundaryConditions& boundary) noexcept;

  /// As solve(), for nodes that have not rotated and without the last corrections.
  void solve_unturned(Eigen::VectorXf& b, const BoundaryConditions& boundary) noexcept;
  /// Compliances of contact points; those of a factor installed while other grasps are held, or of
  /// grasps that have changed since, must be cleared.
  ComplianceColumns& columns() noexcept { return factor_.columns; }

  bool serves(const factor::Held& held) const noexcept {
    return factor_.usable && factor_.panels.usable(held);
  }
  bool is_usable() const noexcept { return factor_.usable; }
  bool is_exact() const noexcept { return factor_.exact; }
  bool is_regularised() const noexcept { return factor_.regularised; }
  const StepFactors& step() const noexcept { return factor_.step; }
  const NodeWarp& warp() const noexcept { return warp_; }
  double age() const noexcept { return age_; }  // s since the snapshot
  void advance(double dt) noexcept { age_ += dt; }

  void want_new() noexcept { wanted_ = true; }
  void clear_wanted() noexcept { wanted_ = false; }
  bool is_new_wanted() const noexcept { return wanted_; }

  SecantPairs& secants() noexcept { return secants_; }

  /// Rotations of the nodes at the last evaluation of `elements`, as quaternions w x y z.
  const Eigen::Matrix4Xf& measure_rotations(ElementForces& elements) noexcept;
  /// Rotates the factor with the nodes as of the last evaluation of `elements`.
  void follow(ElementForces& elements) noexcept;
  /// Takes the factor `computed`, whose snapshot is `age` seconds old, in exchange for the present
  /// one.
  void install(LoopFactor& computed, double age, ElementForces& elements) noexcept;
  /// Returns to nodes that have not rotated.
  void reset() noexcept;

 private:
  const SolverOptions& options_;
  LoopFactor factor_;
  double age_ = 0;
  Eigen::Matrix4Xf rotations_;  // of the nodes, when last measured
  NodeWarp warp_;
  SecantPairs secants_;
  bool wanted_ = false;
};

}  // namespace palpate::elasticity
