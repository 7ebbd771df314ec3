#include "core/estimation/consistency/learning_guard.hpp"

namespace palpate::estimation {
namespace {

/// Corrects the shape, faded, and the prediction by a change of the filter's mean since `before`.
void follow(const WrenchFilter::Vector& before, const Innovation& now, FusedState& state,
            WrenchUpdate& wrenches) noexcept {
  const WrenchFilter::Vector change = state.filter.mean() - before;
  state.shift -= change.head(state.filter.shape_size());
  wrenches.follow(now.held, now.H, change, state);
}

}  // namespace

LearningGuard::LearningGuard(const elasticity::Body& body, const mesh::Surface& surface,
                             const WrenchSampling& sampling, const WrenchFilter::Options& priors,
                             const Options& options)
    : is_enabled_(options.enabled),
      test_(body, sampling, priors, options),
      explanations_(body, surface, test_.knowledge()),
      prior_(static_cast<int>(body.grasps.size()), priors),
      initial_(prior_),
      history_(WrenchConsistency::kSnapshots, prior_) {}

void LearningGuard::reset() noexcept {
  test_.reset();
  explanations_.reset();
  report_ = DiscrepancyReport();
  initial_ = prior_;
  newest_ = 0;
}

bool LearningGuard::permits(const Innovation& now, bool has_contact, FusedState& state,
                            WrenchUpdate& wrenches,
                            const elasticity::DeformationModel& model) noexcept {
  if (!is_enabled_) return true;
  const bool was_inconsistent = test_.is_inconsistent();
  if (test_.take(now, state, model, !has_contact)) {
    newest_ = (newest_ + 1) % WrenchConsistency::kSnapshots;
    history_[static_cast<std::size_t>(newest_)] = state.filter;
  }
  if (!test_.has_tested()) return !test_.is_inconsistent();
  if (test_.has_just_begun()) fall_back(now, state, wrenches);
  explanations_.take(test_, state, model);
  if (const CauseHypothesis* cause = explanations_.certain()) adopt(*cause, now, state, wrenches);
  test_.write(report_);
  if (report_.is_inconsistent && !was_inconsistent) {
    report_.time = 0;
    report_.adopted = Cause::kUnknown;
  }
  explanations_.write(report_);
  return !test_.is_inconsistent();
}

void LearningGuard::advance(double dt) noexcept {
  if (!is_enabled_) return;
  explanations_.advance(dt);
  if (report_.is_inconsistent) report_.time += dt;
}

void LearningGuard::fall_back(const Innovation& now, FusedState& state,
                              WrenchUpdate& wrenches) const noexcept {
  if (state.filter.has_loads() || state.filter.has_contact()) return;
  constexpr int kCount = WrenchConsistency::kSnapshots;
  const int back = test_.snapshots_back();
  const WrenchFilter::Vector before = state.filter.mean();
  state.filter = back >= kCount
                     ? initial_
                     : history_[static_cast<std::size_t>((newest_ - back + 1 + kCount) % kCount)];
  follow(before, now, state, wrenches);
}

void LearningGuard::adopt(const CauseHypothesis& cause, const Innovation& now, FusedState& state,
                          WrenchUpdate& wrenches) noexcept {
  WrenchFilter& filter = state.filter;
  if (filter.has_loads() || filter.has_contact()) return;
  const WrenchFilter::Vector before = filter.mean();
  const bool is_slip = cause.cause() == Cause::kSlip;
  filter.shift(is_slip ? filter.offset(cause.hand()) : filter.bias(cause.hand()), cause.value(),
               cause.covariance());
  follow(before, now, state, wrenches);
  report_.adopted = cause.cause();
  test_.resume(cause.absorbed());
  explanations_.finish();
  initial_ = filter;
}

}  // namespace palpate::estimation
