#pragma once

#include <vector>

#include "core/estimation/fused_state.hpp"

namespace palpate::estimation {

/// Standard deviations of the positions of all nodes, from the covariance of the fused state and
/// the local error of the mesh. Nothing allocates after construction.
class NodeDeviations {
 public:
  /// `own`: m, standard deviation of the local error of the mesh, independent of the state.
  NodeDeviations(int nodes, double own)
      : own_(own), deviations_(static_cast<std::size_t>(nodes), 0.0F) {}

  void reset() noexcept;
  /// Updates one tenth of the nodes. Call once per tick.
  void update(const FusedState& state, const elasticity::DeformationModel& model) noexcept;
  /// m, root mean square over the axes; zero before the first update.
  const std::vector<float>& values() const noexcept { return deviations_; }

 private:
  double own_;
  std::vector<float> deviations_;
  int next_ = 0;
};

}  // namespace palpate::estimation
