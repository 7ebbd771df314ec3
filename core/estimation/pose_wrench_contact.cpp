// PoseWrenchFilter: detection and tracking of an unmodelled external contact.
#include <algorithm>
#include <cmath>

#include "core/estimation/pose_wrench_filter.hpp"

namespace palpate::estimation {
namespace {

// s of rest before a wrench change may indicate an external contact
constexpr double kRestFirst = 0.8;
constexpr double kOfLate = 0.05;  // s, window of the short-term mean
// Chi-square threshold of a hand's change: false alarm rate 1 in 160.
constexpr double kRising = 18;
constexpr double kSudden = 28;    // the same for a sudden change: false alarm rate 1 in 10,000
constexpr int kSuddenInARow = 2;  // consecutive sudden changes: no false alarm within hours
constexpr double kWary = 8;  // factor on the thresholds within kWaryFor after a contact has ended
constexpr double kWaryFor = 0.3;  // s, time in which the object oscillates and the pads relax
// Factor on the usual noise below which a contact is barely detectable.
constexpr double kFaint = 6;
// Relative error of the predicted response to an external contact, which is a small change.
constexpr double kPushError = 0.05;

}  // namespace

void PoseWrenchFilter::load_with_unknown(elasticity::DeformationModel& model) const noexcept {
  if (!filter_.has_contact()) return;
  const Eigen::Vector3d force = filter_.mean().tail<3>() / stiffness();
  const mesh::PointWeights& point = search_.place(place_).point;
  for (int i = 0; i < point.count; ++i)
    model.loads().col(point.nodes[i]) += point.weights[i] * force;
}

/// Whether the hand has moved from its rest pose, which is then reset to the present one, or has
/// moved recently. The change of the wrench when a hand starts to move is not an external contact.
bool PoseWrenchFilter::has_moved(int grasp, const GraspInput& input, double dt) noexcept {
  constexpr double kSettles = 0.1;  // s
  constexpr double kTurn = 10;      // rad/m
  if (!input.X_OG.matrix().allFinite()) return false;
  Hand& hand = hands_[grasp];
  math::Pose& rest = hand.X_OG_rest;
  math::Vector6d off;
  off << input.X_OG.translation() - rest.translation(),
      math::log_rotation(input.X_OG.linear() * rest.linear().transpose());
  const auto is_beyond = [](const math::Vector6d& way, double distance) {
    return way.head<3>().norm() > distance || way.tail<3>().norm() > kTurn * distance;
  };
  if (is_beyond(off, options_.rest_distance)) {
    rest = input.X_OG;
    hand.off_rest.setZero();
    return true;
  }
  hand.off_rest += std::min(1.0, dt / kSettles) * (off - hand.off_rest);
  return is_beyond(off - hand.off_rest, options_.rest_recently);
}

int PoseWrenchFilter::wrenches_in(double seconds) const noexcept {
  return std::max(1, static_cast<int>(std::lround(seconds / options_.period)));
}

bool PoseWrenchFilter::is_settled(const Innovation& now) const noexcept {
  return at_rest_count_ >= wrenches_in(kRestFirst) && at_rest_held_ == now.held;
}

void PoseWrenchFilter::accumulate_innovation(const Innovation& now) noexcept {
  latest_ = now.y;
  if (at_rest_count_ > 0 && at_rest_held_ == now.held) {
    recent_ += (now.y - recent_) / wrenches_in(kOfLate);
    return;
  }
  at_rest_ = recent_ = now.y;
  at_rest_measured_ = now.measured;
  at_rest_noise_ = at_rest_spread_ = WrenchFilter::Wrenches::Zero(now.y.size());
  at_rest_held_ = now.held;
  at_rest_count_ = 1;
}

/// Updates the baseline of the wrenches at rest and their spread.
void PoseWrenchFilter::update_rest_baseline(const Innovation& now) noexcept {
  constexpr double kLongest = 2;  // s, averaging window
  at_rest_count_ = std::min(at_rest_count_ + 1, wrenches_in(kLongest));
  const WrenchFilter::Wrenches off = recent_ - at_rest_;
  at_rest_spread_ += (off.cwiseAbs2() - at_rest_spread_) / at_rest_count_;
  at_rest_noise_ += ((latest_ - at_rest_).cwiseAbs2() - at_rest_noise_) / at_rest_count_;
  at_rest_ += off / at_rest_count_;
  at_rest_measured_ += (now.measured - at_rest_measured_) / at_rest_count_;
}

/// Change of the wrenches since the hands came to rest. Causes: an external contact, sensor noise,
/// or residual oscillation of the object, which appears in the spread of the wrenches.
PoseWrenchFilter::Innovation PoseWrenchFilter::change(const Innovation& now) const noexcept {
  Innovation result = now;
  result.y = recent_ - at_rest_;
  result.H.leftCols(filter_.contact()).setZero();
  result.R.setZero();
  // Equivalent number of equally weighted wrenches.
  const double mean_of = 2.0 * wrenches_in(kOfLate) - 1;
  for (int row = 0; row < result.y.size(); ++row) {
    const double noise = row % 6 < 3 ? options_.force : options_.torque;
    result.R(row, row) = std::max(noise * noise / mean_of, at_rest_spread_[row]);
  }
  return result;
}

/// Covariance of a mean of `count` wrenches: their noise at rest and, for the model error, a
/// fraction of the change caused by the contact.
WrenchFilter::Noise PoseWrenchFilter::noise(const WrenchFilter::Wrenches& pushed,
                                            int count) const noexcept {
  constexpr double kLeast = 0.3;      // lower bound, as a fraction of the expected noise
  constexpr double kUncertain = 1.3;  // margin for the uncertainty of the estimated spread
  WrenchFilter::Noise R = WrenchFilter::Noise::Zero(pushed.size(), pushed.size());
  for (int row = 0; row < pushed.size(); ++row) {
    const double least = kLeast * (row % 6 < 3 ? options_.force : options_.torque);
    const double error = kPushError * pushed.segment<3>(row - row % 3).norm();
    R(row, row) = std::max(kUncertain * at_rest_noise_[row], least * least) / count + error * error;
  }
  return R;
}

/// Starts a search for an external contact when the wrenches have changed significantly: two
/// consecutive wrenches by far more than their noise, or the short-term mean for some time.
void PoseWrenchFilter::detect_contact(const Innovation& changed) noexcept {
  const auto rows = static_cast<double>(changed.y.size());
  Innovation now = changed;
  now.y = latest_ - at_rest_;
  now.R = noise(WrenchFilter::Wrenches::Zero(now.y.size()), 1);
  const double wary = 1 + kWary * std::exp(-since_contact_ / kWaryFor);
  const double enough = sudden_ == 0 ? kRising : kSudden;
  const bool sudden = filter_.test(now.H, now.y, now.R) > wary * enough / 6 * rows;
  const bool lasting =
      filter_.test(changed.H, changed.y, changed.R) > wary * options_.gate / 6 * rows;
  sudden_ = sudden ? sudden_ + 1 : 0;
  rejected_innovations_ = sudden || lasting ? rejected_innovations_ + 1 : 0;
  if (rejected_innovations_ <= 1) unexplained_count_ = 0;
  if (rejected_innovations_ == 0) return;
  add_unexplained(now.y);
  if ((sudden_ >= kSuddenInARow || rejected_innovations_ >= options_.suspicions) &&
      !search_.is_searching())
    search_.begin(unexplained_, noise(unexplained_, unexplained_count_), changed.held);
  if (rejected_innovations_ * options_.period > kPatience) at_rest_count_ = 0;  // new baseline
}

/// Adds to the mean change of the wrenches, without the contribution of the known contact.
void PoseWrenchFilter::add_unexplained(const WrenchFilter::Wrenches& change) noexcept {
  constexpr double kLongest = 0.5;  // s, averaging window
  if (unexplained_count_ == 0 || unexplained_.size() != change.size()) {
    unexplained_count_ = 0;
    unexplained_ = change;
  }
  unexplained_count_ = std::min(unexplained_count_ + 1, wrenches_in(kLongest));
  unexplained_ += (change - unexplained_) / unexplained_count_;
}

void PoseWrenchFilter::follow_contact(Innovation changed) noexcept {
  const WrenchFilter::Wrenches pushed = changed.H.rightCols<3>() * filter_.mean().tail<3>();
  changed.y = latest_ - at_rest_;
  changed.R = noise(pushed, 1);
  WrenchFilter::Wrenches usual = pushed;  // expected variances of a wrench
  for (int row = 0; row < usual.size(); ++row) {
    const double deviation = row % 6 < 3 ? options_.force : options_.torque;
    usual[row] = deviation * deviation;
    changed.R(row, row) = std::max(changed.R(row, row), usual[row]);  // oscillation of the object
  }
  const auto rows = static_cast<double>(changed.y.size());
  const double test = filter_.test(changed.H, changed.y, changed.R);
  innovation_test_ = test / rows;
  if (test < 0) return;
  const bool believed = test <= options_.gate / 6 * rows;
  rejected_innovations_ = believed ? 0 : rejected_innovations_ + 1;
  if (rejected_innovations_ == 1) unexplained_count_ = 0;  // the contact has moved, grown or ended
  add_unexplained(changed.y + pushed);
  if (believed) correct(changed);
  const auto is_faint = [&](const WrenchFilter::Wrenches& wrenches) {
    return wrenches.cwiseAbs2().cwiseQuotient(usual).sum() < kFaint / 6 * rows;
  };
  contact_below_noise_ = is_faint(pushed);
  // The hand rests: if the wrench has returned to its baseline, the contact has ended, even if the
  // innovation, whose model error is not that of a small change, suggests otherwise.
  const bool as_before =
      is_faint(changed.y + pushed) || is_faint(changed.measured - at_rest_measured_);
  contact_released_ = rejected_innovations_ >= kSuddenInARow && as_before;
  if (contact_released_) return;
  constexpr double kLookAgain = 0.1;  // s
  const bool look =
      rejected_innovations_ >= kSuddenInARow ||
      (believed && weak_for_ == 0 && unexplained_count_ % wrenches_in(kLookAgain) == 0);
  if (look && !search_.is_searching())
    search_.begin(unexplained_, noise(unexplained_, unexplained_count_), changed.held);
}

void PoseWrenchFilter::judge_search(const elasticity::DeformationModel& model) noexcept {
  constexpr double kExplained = 0.8;
  constexpr double kClearlyBetter = 0.2;
  const ContactSearch::Found& found = search_.found();
  if (found.place < 0 || found.share < kExplained || found.force_O.isZero(0)) return;
  if (filter_.has_contact()) {
    place_deviation_ = search_.spread(place_, model);
    if (found.place == place_ ||
        found.cost + kClearlyBetter > search_.judge(place_, model, motion_).cost)
      return;
  } else if (rejected_innovations_ == 0) {
    return;  // false alarm
  }
  place_contact(found, model);
}

void PoseWrenchFilter::place_contact(const ContactSearch::Found& found,
                                     const elasticity::DeformationModel& model) noexcept {
  if (filter_.has_contact()) {
    load_contact(-filter_.mean().tail<3>(), model);
  } else {
    unexplained_count_ = 0;  // the contact may have begun within the first of them
  }
  place_ = found.place;
  place_deviation_ = search_.spread(place_, model);
  filter_.begin_contact(found.force_O, found.covariance);
  load_contact(found.force_O, model);
  rejected_innovations_ = sudden_ = 0;
  weak_for_ = 0;
  contact_below_noise_ = contact_released_ = false;
}

void PoseWrenchFilter::drop_contact(const elasticity::DeformationModel& model) noexcept {
  if (!filter_.has_contact()) return;
  load_contact(-filter_.mean().tail<3>(), model);
  filter_.end_contact();
  place_ = -1;
  contact_released_ = false;
  unbelieved_for_ = 0;
  rejected_innovations_ = sudden_ = unexplained_count_ = 0;
  since_contact_ = 0;
}

/// The prediction follows a change of the force at once.
void PoseWrenchFilter::load_contact(const Eigen::Vector3d& force_O,
                                    const elasticity::DeformationModel& model) noexcept {
  const mesh::PointWeights& point = search_.place(place_).point;
  for (int g = 0, row = 0; g < filter_.grasp_count(); ++g) {
    // Rows exist for hands with a wrench only.
    const bool has_baseline = at_rest_count_ > 0 && at_rest_held_[g];
    if (model.is_held(g)) {
      const math::Vector6d wrench =
          ContactSearch::response(point, model.sensitivity(), motion_, g) * force_O;
      hands_[g].lagged += wrench;
      hands_[g].sum -= hands_[g].count * wrench;
      if (has_baseline) latest_.segment<6>(row) -= wrench;
    }
    row += has_baseline ? 6 : 0;
  }
  recent_ = latest_;
}

void PoseWrenchFilter::judge_contact(const elasticity::DeformationModel& model,
                                     double dt) noexcept {
  since_contact_ += dt;
  if (!filter_.has_contact()) return;
  constexpr double kStandsOut = 3;  // standard deviations
  constexpr double kFadesIn = 0.3;  // s
  const Eigen::Vector3d force = filter_.mean().tail<3>();
  const Eigen::Matrix3d P = filter_.covariance().bottomRightCorner<3, 3>();
  // While the force is not being estimated, its covariance is meaningless.
  const bool unsure =
      rejected_innovations_ == 0 && force.dot(P.ldlt().solve(force)) < kStandsOut * kStandsOut;
  const bool weak = contact_below_noise_ || unsure;
  weak_for_ = weak ? weak_for_ + dt : 0;
  // A contact that no location explains for this long is dropped: no estimate is better than a
  // wrong one.
  unbelieved_for_ = rejected_innovations_ > 0 ? unbelieved_for_ + dt : 0;
  // The set of hands with a wrench has changed.
  const bool forgotten = at_rest_count_ < wrenches_in(kRestFirst);
  if (weak_for_ >= kFadesIn || unbelieved_for_ >= kFadesIn || contact_released_ || forgotten)
    drop_contact(model);
}

}  // namespace palpate::estimation
