#include "core/estimation/observation_update.hpp"

#include <cmath>

namespace palpate::estimation {

ObservationUpdate::ObservationUpdate(const elasticity::Body& body, const mesh::Surface& surface,
                                     const Options& options)
    : options_(options),
      loads_(body),
      fit_(body.mesh.nodes, surface, options.observation),
      history_(body.mesh.node_count()) {}

void ObservationUpdate::reset() noexcept {
  fit_.reset();
  history_.clear();
  is_active_ = false;
}

void ObservationUpdate::add_loads(const FusedState& state, Eigen::Matrix3Xd& loads) const noexcept {
  if (state.filter.has_loads())
    loads_.add_to(loads, state.applied().segment<WrenchFilter::kLoads>(state.filter.load()));
}

void ObservationUpdate::update(const ObservationInput& seen, FusedState& state,
                               WrenchUpdate& wrenches, elasticity::DeformationModel& model,
                               double dt) noexcept {
  const bool is_new = seen.freshness == Freshness::kNew;
  constexpr double kFaded = 1e-9;  // m, rad, 1, N
  state.shift *= std::exp(-dt / options_.fade);
  if (state.shift.isZero(kFaded)) state.shift.setZero();
  if (!is_active_ && !is_new) return;
  if (!is_active_) loads_.watch(model);
  is_active_ = true;
  history_.record(model.positions(), state.applied(), dt);
  if (is_new) fit_.begin(seen, history_);
  const elasticity::Sensitivity& sensitivity = model.sensitivity();
  if (!fit_.is_busy() || !sensitivity.valid) {
    fit_.wait(dt);
    return;
  }
  if (!state.filter.has_loads() && VirtualLoads::is_known(sensitivity))
    state.filter.begin_loads(loads_.for_distance(options_.shape, sensitivity));
  if (fit_.advance(state.basis(model), dt)) correct(state, wrenches, model);
}

void ObservationUpdate::correct(FusedState& state, WrenchUpdate& wrenches,
                                const elasticity::DeformationModel& model) const noexcept {
  const WrenchFilter::Vector before = state.filter.mean();
  const SurfaceFit::Information& correction = fit_.information();
  if (correction.used == 0 || !state.filter.take(correction.matrix, correction.vector)) return;
  const WrenchFilter::Vector change = state.filter.mean() - before;
  state.shift -= change.head(state.filter.shape_size());
  const std::array<bool, 2> held = held_grasps(model, state.filter.grasp_count());
  wrenches.follow(held, state.wrench_rows(held, model), change, state);
}

}  // namespace palpate::estimation
