#pragma once

#include <vector>

#include "core/estimation/consistency/wrench_consistency.hpp"

namespace palpate::estimation {

/// Standard deviations of the positions of all nodes, from the covariance of the fused state, the
/// errors of the model that no state represents and, while a hand's wrench contradicts the model,
/// the shape that this wrench allows. Nothing allocates after construction.
class NodeDeviations {
 public:
  struct Options {
    /// m, of each axis of the object's position in W. The hands hold other points of the object
    /// than configured then, so that all nodes are displaced alike.
    double clamp = 1e-3;
    /// 1, error of a node's displacement halfway between clamp and hand relative to its size, by
    /// stiffness and dimensions that differ from the model's.
    double shape = 0.03;
  };

  /// `own`: m, standard deviation of the local error of the mesh, independent of the state.
  /// `material`: its Poisson's ratio and density. Throws std::invalid_argument if a number is
  /// negative.
  NodeDeviations(int nodes, double own, const WrenchConsistency::Options& material,
                 const Options& options);

  void reset() noexcept;
  /// The wrench of a hand differs from its prediction by `wrench`, N and N m, at G in O. The hand
  /// would have to be displaced by the compliance of the object times this wrench to explain it:
  /// the difference between the shapes by pose and by wrench bounds the error of the shape.
  void widen(int hand, const math::Vector6d& wrench, const FusedState& state) noexcept;
  /// No wrench contradicts the model any more.
  void narrow() noexcept { displacement_.setZero(); }
  /// Updates one tenth of the nodes. Call once per tick.
  void update(const FusedState& state, const elasticity::DeformationModel& model) noexcept;
  /// m, root mean square over the axes; zero before the first update.
  const std::vector<float>& values() const noexcept { return deviations_; }

 private:
  double variance_of_model(int node, bool is_observed,
                           const elasticity::DeformationModel& model) const noexcept;

  double own_;
  double poisson_, density_;
  Options options_;
  std::vector<float> deviations_;
  int next_ = 0;
  int hand_ = 0;
  /// m, rad, in O; displacement of that hand that explains its wrench.
  math::Vector6d displacement_ = math::Vector6d::Zero();
};

}  // namespace palpate::estimation
