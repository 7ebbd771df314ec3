#include "core/estimation/learning_guard.hpp"

namespace palpate::estimation {

LearningGuard::LearningGuard(const elasticity::Body& body, const WrenchSampling& sampling,
                             const WrenchFilter::Options& priors, const Options& options)
    : is_enabled_(options.enabled),
      test_(body, sampling, priors, options),
      prior_(static_cast<int>(body.grasps.size()), priors),
      history_(WrenchConsistency::kSnapshots, prior_) {}

void LearningGuard::reset() noexcept {
  test_.reset();
  newest_ = 0;
}

bool LearningGuard::permits(const Innovation& now, bool has_contact, FusedState& state,
                            WrenchUpdate& wrenches,
                            const elasticity::DeformationModel& model) noexcept {
  if (!is_enabled_) return true;
  if (test_.take(now, state, model, !has_contact)) {
    newest_ = (newest_ + 1) % WrenchConsistency::kSnapshots;
    history_[static_cast<std::size_t>(newest_)] = state.filter;
  }
  if (test_.has_just_begun()) fall_back(now, state, wrenches);
  return !test_.is_inconsistent();
}

void LearningGuard::fall_back(const Innovation& now, FusedState& state,
                              WrenchUpdate& wrenches) const noexcept {
  if (state.filter.has_loads() || state.filter.has_contact()) return;
  constexpr int kCount = WrenchConsistency::kSnapshots;
  const int back = test_.snapshots_back();
  const WrenchFilter::Vector before = state.filter.mean();
  state.filter = back >= kCount
                     ? prior_
                     : history_[static_cast<std::size_t>((newest_ - back + 1 + kCount) % kCount)];
  const WrenchFilter::Vector change = state.filter.mean() - before;
  state.shift -= change.head(state.filter.shape_size());
  wrenches.follow(now.held, now.H, change, state);
}

}  // namespace palpate::estimation
