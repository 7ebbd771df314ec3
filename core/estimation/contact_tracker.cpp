#include "core/estimation/contact_tracker.hpp"

#include <Eigen/Cholesky>

namespace palpate::estimation {
namespace {

/// Expectation of a chi-square variable with the 6 degrees of freedom of a hand: wrenches below it,
/// relative to the expected noise, are barely detectable.
constexpr double kFaint = 6;

}  // namespace

ContactTracker::ContactTracker(const elasticity::Body& body, const mesh::Surface& surface,
                               const Options& options, const WrenchSampling& sampling)
    : options_(options),
      sampling_(sampling),
      detector_(sampling, options),
      search_(body, surface, options.search) {
  outward_G_.fill(Eigen::Vector3d::Zero());
  const Eigen::Vector3d middle = body.mesh.nodes.rowwise().mean();
  for (std::size_t g = 0; g < body.grasps.size(); ++g) {
    const math::Pose& X_OG = body.grasps[g].X_OG_rest;
    outward_G_[g] = X_OG.linear().transpose() * (X_OG.translation() - middle).normalized();
  }
}

void ContactTracker::reset() noexcept {
  detector_.reset();
  place_ = -1;
  change_count_ = 0;
}

void ContactTracker::restart(FusedState& state, WrenchUpdate& wrenches,
                             const elasticity::DeformationModel& model) noexcept {
  wrenches.baseline().forget();
  detector_.clear();
  change_count_ = 0;
  drop(state, wrenches, model);  // the wrench of a moving hand cannot identify the contact
}

bool ContactTracker::detect(const Innovation& now, FusedState& state,
                            WrenchUpdate& wrenches) noexcept {
  RestBaseline& baseline = wrenches.baseline();
  if (!options_.contacts) {
    detector_.clear();
    return false;
  }
  if (!baseline.is_established(now.held)) return false;
  const Innovation lasting = baseline.change(now, state.filter.contact());
  Innovation sudden = lasting;
  sudden.y = baseline.latest_change();
  sudden.R = baseline.noise(WrenchFilter::Wrenches::Zero(sudden.y.size()), 1);
  const double sudden_test = state.filter.test(sudden.H, sudden.y, sudden.R);
  const double lasting_test = state.filter.test(lasting.H, lasting.y, lasting.R);
  detector_.judge_change(sudden_test, lasting_test, now.rows());
  if (detector_.unexplained_count() <= 1) change_count_ = 0;
  if (detector_.state() == ContactDetector::State::kNone) return false;
  add_change(sudden.y);
  if (detector_.wants_search() && !search_.is_searching()) begin_search(baseline, now.held);
  if (detector_.needs_baseline()) baseline.forget();
  return true;
}

void ContactTracker::track(const Innovation& now, FusedState& state,
                           WrenchUpdate& wrenches) noexcept {
  RestBaseline& baseline = wrenches.baseline();
  if (!baseline.is_established(now.held)) return;
  Innovation changed = baseline.change(now, state.filter.contact());
  const WrenchFilter::Wrenches pushed = changed.H.rightCols<3>() * state.filter.mean().tail<3>();
  changed.y = baseline.latest_change();
  changed.R = baseline.noise(pushed, 1);
  WrenchFilter::Wrenches usual = pushed;  // expected variances of a wrench
  for (int row = 0; row < usual.size(); ++row) {
    const double deviation = sampling_.deviation(row);
    usual[row] = deviation * deviation;
    changed.R(row, row) = std::max(changed.R(row, row), usual[row]);  // oscillation of the object
  }
  const double rows = changed.rows();
  const double test = wrenches.test(changed, state);
  if (test < 0) return;
  const auto is_faint = [&](const WrenchFilter::Wrenches& wrench) {
    return wrench.cwiseAbs2().cwiseQuotient(usual).sum() < kFaint / kHandRows * rows;
  };
  // The hand rests: if the wrench has returned to its baseline, the contact has ended, even if the
  // innovation, whose model error is not that of a small change, suggests otherwise.
  detector_.judge_contact(
      test, rows, is_faint(pushed),
      is_faint(changed.y + pushed) || is_faint(changed.measured - baseline.measured()));
  if (detector_.unexplained_count() == 1) change_count_ = 0;  // the contact has moved or grown
  add_change(changed.y + pushed);
  const bool explained = detector_.state() == ContactDetector::State::kTracking;
  if (explained) wrenches.correct(changed, state);
  constexpr double kLookAgain = 0.1;  // s
  const bool look =
      detector_.wants_new_location() ||
      (explained && !detector_.is_weak() && change_count_ % sampling_.updates_in(kLookAgain) == 0);
  if (look && !search_.is_searching()) begin_search(baseline, changed.held);
}

/// Adds to the mean change of the wrenches, without the contribution of the known contact.
void ContactTracker::add_change(const WrenchFilter::Wrenches& change) noexcept {
  constexpr double kLongest = 0.5;  // s, averaging window
  if (change_count_ == 0 || change_.size() != change.size()) {
    change_count_ = 0;
    change_ = change;
  }
  change_count_ = std::min(change_count_ + 1, sampling_.updates_in(kLongest));
  change_ += (change - change_) / change_count_;
}

void ContactTracker::begin_search(const RestBaseline& baseline,
                                  const std::array<bool, 2>& held) noexcept {
  search_.begin(change_, baseline.noise(change_, change_count_), held);
}

void ContactTracker::advance(double dt, FusedState& state, WrenchUpdate& wrenches,
                             const elasticity::DeformationModel& model) noexcept {
  constexpr int kPlaces = 1000;  // candidates per tick, 0.2 ms
  if (search_.is_searching() && search_.advance(model, state.motion, kPlaces))
    judge_search(state, wrenches, model);
  double significance = 0;
  if (state.filter.has_contact()) {
    const Eigen::Vector3d force = state.filter.mean().tail<3>();
    const Eigen::Matrix3d P = state.filter.covariance().bottomRightCorner<3, 3>();
    significance = force.dot(P.ldlt().solve(force));
  }
  if (detector_.advance(dt, significance, wrenches.baseline().is_established()))
    drop(state, wrenches, model);
}

void ContactTracker::judge_search(FusedState& state, WrenchUpdate& wrenches,
                                  const elasticity::DeformationModel& model) noexcept {
  constexpr double kExplained = 0.8;      // least share of the change that a contact explains
  constexpr double kClearlyBetter = 0.2;  // least improvement of the cost, for another location
  const ContactSearch::Found& found = search_.found();
  if (found.place < 0 || found.share < kExplained || found.force_O.isZero(0)) return;
  if (detector_.has_contact()) {
    place_deviation_ = search_.spread(place_, model);
    if (found.place == place_ ||
        found.cost + kClearlyBetter > search_.judge(place_, model, state.motion).cost)
      return;
  } else if (detector_.state() == ContactDetector::State::kNone || may_be_setting_off(state)) {
    return;  // false alarm
  }
  place(found, state, wrenches, model);
}

/// Whether the change of the wrench may be the inertia of a hand whose motion is not yet seen: it
/// explains the change nearly as well as the contact found.
bool ContactTracker::may_be_setting_off(const FusedState& state) const noexcept {
  constexpr double kSeenAfter = 0.2;  // s, after which the motion would have been seen
  constexpr double kNearly = 6;       // chi-square
  if (detector_.unexplained_time() > kSeenAfter) return false;
  for (int g = 0; g < state.filter.grasp_count(); ++g) {
    const auto hand = static_cast<std::size_t>(g);
    const Eigen::Vector3d outward_O = state.X_OG[hand].linear() * outward_G_[hand];
    if (search_.cost_of_setting_off(g, outward_O) < search_.found().cost + kNearly) return true;
  }
  return false;
}

void ContactTracker::place(const ContactSearch::Found& found, FusedState& state,
                           WrenchUpdate& wrenches,
                           const elasticity::DeformationModel& model) noexcept {
  if (detector_.has_contact()) {
    wrenches.follow_contact(-state.filter.mean().tail<3>(), state, model);
  } else {
    change_count_ = 0;  // the contact may have begun within the first of them
  }
  place_ = found.place;
  place_deviation_ = search_.spread(place_, model);
  state.contact_point = search_.place(place_).point;
  state.filter.begin_contact(found.force_O, found.covariance);
  wrenches.follow_contact(found.force_O, state, model);
  detector_.begin();
}

void ContactTracker::drop(FusedState& state, WrenchUpdate& wrenches,
                          const elasticity::DeformationModel& model) noexcept {
  if (!detector_.has_contact()) return;
  wrenches.follow_contact(-state.filter.mean().tail<3>(), state, model);
  state.filter.end_contact();
  place_ = -1;
  change_count_ = 0;
  detector_.end();
}

UnknownContact ContactTracker::estimate(const WrenchFilter& filter,
                                        const elasticity::DeformationModel& model) const noexcept {
  UnknownContact contact;
  if (!detector_.is_confirmed()) return contact;
  contact.found = true;
  contact.location_O = search_.place(place_).point.interpolate(model.positions());
  contact.force_O = filter.mean().tail<3>();
  contact.deviation = std::sqrt(filter.covariance().diagonal().tail<3>().maxCoeff());
  contact.location_deviation =
      place_deviation_ <= options_.search.observable ? place_deviation_ : -1;
  return contact;
}

}  // namespace palpate::estimation
