#include "core/estimation/consistency/learning_guard.hpp"

namespace palpate::estimation {

LearningGuard::LearningGuard(const elasticity::Body& body, const mesh::Surface& surface,
                             const WrenchSampling& sampling, const WrenchFilter::Options& priors,
                             const Options& options)
    : is_enabled_(options.enabled),
      test_(body, sampling, priors, options),
      explanations_(body, surface, test_.knowledge()) {}

void LearningGuard::reset() noexcept {
  test_.reset();
  explanations_.reset();
  report_ = DiscrepancyReport();
}

void LearningGuard::take_over(const WrenchFilter& filter) noexcept { test_.take_over(filter); }

bool LearningGuard::permits(const Innovation& now, bool has_contact, FusedState& state,
                            WrenchUpdate& wrenches,
                            const elasticity::DeformationModel& model) noexcept {
  if (!is_enabled_) return true;
  const bool was_inconsistent = test_.is_inconsistent();
  test_.take(now, state, model, !has_contact);
  const bool can_assume = !state.filter.has_loads() && !state.filter.has_contact();
  const bool may_learn = !can_assume && !test_.is_inconsistent();
  if (can_assume && !has_contact && !test_.is_inconsistent()) wrenches.absorb(now);
  if (!test_.has_tested()) return may_learn;
  explanations_.take(test_, state, model);
  test_.suspect(explanations_.suspects_lasting_cause());
  const CauseHypothesis* cause = explanations_.certain();
  const bool adopts = cause != nullptr && can_assume;
  if (adopts) {
    report_.adopted = cause->cause();
    test_.resume(cause->absorbed());
    explanations_.finish();
  }
  if (can_assume && !has_contact) assume(now, test_.is_inconsistent() || adopts, state, wrenches);
  test_.write(report_);
  if (report_.is_inconsistent && !was_inconsistent) {
    report_.time = 0;
    report_.adopted = Cause::kUnknown;
  }
  explanations_.write(report_);
  return may_learn;
}

void LearningGuard::advance(double dt) noexcept {
  if (!is_enabled_) return;
  explanations_.advance(dt);
  if (report_.is_inconsistent) report_.time += dt;
}

/// `is_faded`: the shape follows the change gradually.
void LearningGuard::assume(const Innovation& now, bool is_faded, FusedState& state,
                           WrenchUpdate& wrenches) const noexcept {
  const WrenchFilter::Vector before = state.filter.mean();
  WrenchKnowledge::Vector mean;
  WrenchKnowledge::Matrix covariance;
  test_.knowledge().write(mean, covariance);
  state.filter.assume(mean, covariance);
  const WrenchFilter::Vector change = state.filter.mean() - before;
  if (is_faded) state.shift -= change.head(state.filter.shape_size());
  wrenches.follow(now.held, now.H, change, state);
}

}  // namespace palpate::estimation
