// What of the filter looks for somebody else's push and follows it.
#include <algorithm>
#include <cmath>

#include "core/estimation/pose_wrench_filter.hpp"

namespace palpate::estimation {
namespace {

constexpr double kRestFirst = 0.8;  // s, before a change of the wrench tells of a push
constexpr double kOfLate = 0.05;    // s, of the mean of late
constexpr double kRising = 18;      // normalised square of a hand's change: once in 160 by chance,
constexpr double kSudden = 28;    // and this once in 10,000, just after the other not within hours;
constexpr int kSuddenInARow = 2;  // a search that finds a place for it is rarer still
constexpr double kWary = 8;       // and this many times more just after a push has gone,
constexpr double kWaryFor = 0.3;  // s, while the object swings and the pads slide back
constexpr double kFaint = 6;      // and, of the usual noise, of one that is hardly any
constexpr double kPushError = 0.05;  // 1, of the answer to a push, which is a small change

}  // namespace

void PoseWrenchFilter::load_with_unknown(elasticity::DeformationModel& model) const noexcept {
  if (!filter_.has_contact()) return;
  const Eigen::Vector3d force = filter_.mean().tail<3>() / stiffness();
  const mesh::PointWeights& point = search_.place(place_).point;
  for (int i = 0; i < point.count; ++i)
    model.loads().col(point.nodes[i]) += point.weights[i] * force;
}

/// From where it came to rest, then that is where it is now; or of late. What a hand that sets
/// about to move does to its wrench is no push.
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

void PoseWrenchFilter::remember(const Innovation& now) noexcept {
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

/// Learns how the wrenches are while nothing happens, and how they spread.
void PoseWrenchFilter::settle(const Innovation& now) noexcept {
  constexpr double kLongest = 2;  // s, of the means
  at_rest_count_ = std::min(at_rest_count_ + 1, wrenches_in(kLongest));
  const WrenchFilter::Wrenches off = recent_ - at_rest_;
  at_rest_spread_ += (off.cwiseAbs2() - at_rest_spread_) / at_rest_count_;
  at_rest_noise_ += ((latest_ - at_rest_).cwiseAbs2() - at_rest_noise_) / at_rest_count_;
  at_rest_ += off / at_rest_count_;
  at_rest_measured_ += (now.measured - at_rest_measured_) / at_rest_count_;
}

/// What has changed of late since the hands came to rest: a push can be behind it, the sensor's
/// noise, or an object that still swings, which shows in how the wrenches have spread.
PoseWrenchFilter::Innovation PoseWrenchFilter::change(const Innovation& now) const noexcept {
  Innovation result = now;
  result.y = recent_ - at_rest_;
  result.H.leftCols(filter_.contact()).setZero();
  result.R.setZero();
  const double mean_of = 2.0 * wrenches_in(kOfLate) - 1;  // as many wrenches, all alike
  for (int row = 0; row < result.y.size(); ++row) {
    const double noise = row % 6 < 3 ? options_.force : options_.torque;
    result.R(row, row) = std::max(noise * noise / mean_of, at_rest_spread_[row]);
  }
  return result;
}

/// Covariance of a mean of so many wrenches: their noise while nothing happened, and for the
/// model's own error a share of what a push has changed them by.
WrenchFilter::Noise PoseWrenchFilter::noise(const WrenchFilter::Wrenches& pushed,
                                            int count) const noexcept {
  constexpr double kLeast = 0.3;      // of the noise that is expected
  constexpr double kUncertain = 1.3;  // the spread is an estimate, too
  WrenchFilter::Noise R = WrenchFilter::Noise::Zero(pushed.size(), pushed.size());
  for (int row = 0; row < pushed.size(); ++row) {
    const double least = kLeast * (row % 6 < 3 ? options_.force : options_.torque);
    const double error = kPushError * pushed.segment<3>(row - row % 3).norm();
    R(row, row) = std::max(kUncertain * at_rest_noise_[row], least * least) / count + error * error;
  }
  return R;
}

/// Begins to look for a push where the wrenches have changed too much: the last two by far more
/// than their noise, or their mean of late for some time.
void PoseWrenchFilter::watch(const Innovation& changed) noexcept {
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
  suspicions_ = sudden || lasting ? suspicions_ + 1 : 0;
  if (suspicions_ <= 1) unexplained_count_ = 0;
  if (suspicions_ == 0) return;
  add_unexplained(now.y);
  if ((sudden_ >= kSuddenInARow || suspicions_ >= options_.suspicions) && !search_.is_searching())
    search_.begin(unexplained_, noise(unexplained_, unexplained_count_), changed.held);
  if (suspicions_ * options_.period > kPatience) at_rest_count_ = 0;  // then that is rest
}

/// Into the mean of what the wrenches have changed by, the contact that is known not counted.
void PoseWrenchFilter::add_unexplained(const WrenchFilter::Wrenches& change) noexcept {
  constexpr double kLongest = 0.5;  // s, of the mean
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
  WrenchFilter::Wrenches usual = pushed;  // variances that are expected of a wrench
  for (int row = 0; row < usual.size(); ++row) {
    const double deviation = row % 6 < 3 ? options_.force : options_.torque;
    usual[row] = deviation * deviation;
    changed.R(row, row) = std::max(changed.R(row, row), usual[row]);  // an object swings
  }
  const auto rows = static_cast<double>(changed.y.size());
  const double test = filter_.test(changed.H, changed.y, changed.R);
  innovation_test_ = test / rows;
  if (test < 0) return;
  const bool believed = test <= options_.gate / 6 * rows;
  suspicions_ = believed ? 0 : suspicions_ + 1;
  if (suspicions_ == 1) unexplained_count_ = 0;  // it has moved, grown or gone
  add_unexplained(changed.y + pushed);
  if (believed) correct(changed);
  const auto is_faint = [&](const WrenchFilter::Wrenches& wrenches) {
    return wrenches.cwiseAbs2().cwiseQuotient(usual).sum() < kFaint / 6 * rows;
  };
  faint_ = is_faint(pushed);
  // The hand rests: where it feels again what it did before, nobody pushes, even if the model's
  // answer, which is not that of a small push, says otherwise.
  const bool as_before =
      is_faint(changed.y + pushed) || is_faint(changed.measured - at_rest_measured_);
  gone_ = suspicions_ >= kSuddenInARow && as_before;
  if (gone_) return;
  constexpr double kLookAgain = 0.1;  // s
  const bool look =
      suspicions_ >= kSuddenInARow ||
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
  } else if (suspicions_ == 0) {
    return;  // it was nothing
  }
  place_contact(found, model);
}

void PoseWrenchFilter::place_contact(const ContactSearch::Found& found,
                                     const elasticity::DeformationModel& model) noexcept {
  if (filter_.has_contact()) {
    push(-filter_.mean().tail<3>(), model);
  } else {
    unexplained_count_ = 0;  // it may have begun within the first of them
  }
  place_ = found.place;
  place_deviation_ = search_.spread(place_, model);
  filter_.begin_contact(found.force_O, found.covariance);
  push(found.force_O, model);
  suspicions_ = sudden_ = 0;
  weak_for_ = 0;
  faint_ = gone_ = false;
}

void PoseWrenchFilter::drop_contact(const elasticity::DeformationModel& model) noexcept {
  if (!filter_.has_contact()) return;
  push(-filter_.mean().tail<3>(), model);
  filter_.end_contact();
  place_ = -1;
  gone_ = false;
  unbelieved_for_ = 0;
  suspicions_ = sudden_ = unexplained_count_ = 0;
  since_contact_ = 0;
}

/// The prediction follows a change of the force at once.
void PoseWrenchFilter::push(const Eigen::Vector3d& force_O,
                            const elasticity::DeformationModel& model) noexcept {
  const mesh::PointWeights& point = search_.place(place_).point;
  for (int g = 0, row = 0; g < filter_.grasp_count(); ++g) {
    const bool told = at_rest_count_ > 0 && at_rest_held_[g];  // rows are those of who tells
    if (model.is_held(g)) {
      const math::Vector6d wrench =
          ContactSearch::response(point, model.sensitivity(), motion_, g) * force_O;
      hands_[g].lagged += wrench;
      hands_[g].sum -= hands_[g].count * wrench;
      if (told) latest_.segment<6>(row) -= wrench;
    }
    row += told ? 6 : 0;
  }
  recent_ = latest_;
}

void PoseWrenchFilter::judge_contact(const elasticity::DeformationModel& model,
                                     double dt) noexcept {
  since_contact_ += dt;
  if (!filter_.has_contact()) return;
  constexpr double kStandsOut = 3;  // deviations
  constexpr double kFadesIn = 0.3;  // s
  const Eigen::Vector3d force = filter_.mean().tail<3>();
  const Eigen::Matrix3d P = filter_.covariance().bottomRightCorner<3, 3>();
  // While nothing is learnt of it, its covariance says nothing.
  const bool unsure =
      suspicions_ == 0 && force.dot(P.ldlt().solve(force)) < kStandsOut * kStandsOut;
  const bool weak = faint_ || unsure;
  weak_for_ = weak ? weak_for_ + dt : 0;
  // What no place explains for so long has been sought in vain: better none than a wrong one.
  unbelieved_for_ = suspicions_ > 0 ? unbelieved_for_ + dt : 0;
  const bool forgotten = at_rest_count_ < wrenches_in(kRestFirst);  // which hands tell has changed
  if (weak_for_ >= kFadesIn || unbelieved_for_ >= kFadesIn || gone_ || forgotten)
    drop_contact(model);
}

}  // namespace palpate::estimation
