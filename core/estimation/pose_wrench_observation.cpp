// PoseWrenchFilter: update by observations of the shape.
#include <cmath>

#include "core/estimation/pose_wrench_filter.hpp"

namespace palpate::estimation {

SurfaceFit::Basis PoseWrenchFilter::basis(
    const elasticity::DeformationModel& model) const noexcept {
  SurfaceFit::Basis basis;
  basis.sensitivity = &model.sensitivity();
  basis.filter = &filter_;
  basis.motion = &motion_;
  for (int g = 0; g < filter_.grasp_count(); ++g) basis.held[g] = model.is_held(g);
  return basis;
}

/// Part of a held grasp's predicted wrench that does not belong to the filter's mean: the
/// corrections not yet faded in, and the virtual loads, which are not physical.
math::Vector6d PoseWrenchFilter::wrench_of_shift(
    int grasp, const elasticity::DeformationModel& model) const noexcept {
  if (!model.sensitivity().valid) return math::Vector6d::Zero();
  WrenchFilter::ShapeState off = shift_;
  if (filter_.has_loads())
    off.segment<WrenchFilter::kLoads>(filter_.load()) +=
        filter_.mean().segment<WrenchFilter::kLoads>(filter_.load());
  return stiffness() * motion_.wrench_by_state().middleRows<6>(6 * grasp) * off;
}

/// The shape history is recorded from the first message on, so that later messages find the shape
/// at their acquisition time.
void PoseWrenchFilter::update_observation(const ObservationInput& seen,
                                          elasticity::DeformationModel& model, double dt) noexcept {
  const bool is_new = seen.freshness == sensing::Freshness::kNew;
  if (!is_seen_ && !is_new) return;
  if (!is_seen_) loads_.watch(model);
  is_seen_ = true;
  shift_ *= std::exp(-dt / options_.fade);
  history_.record(model.positions(), applied(), dt);
  if (is_new) observation_fit_.begin(seen, history_);
  const elasticity::Sensitivity& sensitivity = model.sensitivity();
  if (!observation_fit_.is_busy() || !sensitivity.valid) {
    observation_fit_.wait(dt);
    return;
  }
  if (!filter_.has_loads() && VirtualLoads::is_known(sensitivity))
    filter_.begin_loads(loads_.for_distance(options_.shape, sensitivity));
  if (observation_fit_.advance(basis(model), dt)) apply_observation(model);
}

void PoseWrenchFilter::apply_observation(const elasticity::DeformationModel& model) noexcept {
  const WrenchFilter::Vector before = filter_.mean();
  const SurfaceFit::Information& correction = observation_fit_.information();
  if (correction.used == 0 || !filter_.take(correction.matrix, correction.vector)) return;
  const WrenchFilter::Vector change = filter_.mean() - before;
  shift_ -= change.head(filter_.shape_size());
  std::array<bool, 2> held{};
  for (int g = 0; g < filter_.grasp_count(); ++g) held[g] = model.is_held(g);
  follow(held, wrench_rows(held, model), change);
}

}  // namespace palpate::estimation
