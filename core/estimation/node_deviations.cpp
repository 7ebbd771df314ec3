#include "core/estimation/node_deviations.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::estimation {

void NodeDeviations::reset() noexcept { std::fill(deviations_.begin(), deviations_.end(), 0.0F); }

void NodeDeviations::update(const FusedState& state,
                            const elasticity::DeformationModel& model) noexcept {
  if (!model.sensitivity().valid) return;
  const WrenchFilter& filter = state.filter;
  const SurfaceFit::Basis now = state.basis(model);
  const int columns = filter.has_loads() ? filter.shape_size() : filter.load();
  SurfaceFit::NodeRows rows, J(3, columns), JP(3, columns);
  const double own = own_ * own_;
  const int nodes = static_cast<int>(deviations_.size());
  for (int i = 0; i < nodes / 10 + 1; ++i, next_ = (next_ + 1) % nodes) {
    rows.setZero(3, filter.shape_size());
    SurfaceFit::add_node(now, next_, 1, rows);
    J.noalias() = rows * state.motion.by_state().leftCols(columns);
    JP.noalias() = J * filter.covariance().topLeftCorner(columns, columns);
    const double variance = JP.cwiseProduct(J).sum() / 3 + own;
    deviations_[static_cast<std::size_t>(next_)] =
        static_cast<float>(std::sqrt(std::max(0.0, variance)));
  }
}

}  // namespace palpate::estimation
