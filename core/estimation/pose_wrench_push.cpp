// What of the filter looks for somebody else's push and follows it.
#include <algorithm>
#include <cmath>

#include "core/estimation/pose_wrench_filter.hpp"

namespace palpate::estimation {
namespace {

constexpr double kRecent = 0.2;  // weight of a new wrench in the mean of late

}  // namespace

void PoseWrenchFilter::load_with_unknown(elasticity::DeformationModel& model) const noexcept {
  if (!filter_.has_contact()) return;
  const Eigen::Vector3d force = filter_.mean().tail<3>() / stiffness();
  const mesh::PointWeights& point = search_.place(place_).point;
  for (int i = 0; i < point.count; ++i)
    model.loads().col(point.nodes[i]) += point.weights[i] * force;
}

/// From where it came to rest; then that is where it is now.
bool PoseWrenchFilter::has_moved(int grasp, const GraspInput& input) noexcept {
  if (!input.X_OG.matrix().allFinite()) return false;
  math::Pose& rest = hands_[grasp].X_OG_rest;
  const double way = (input.X_OG.translation() - rest.translation()).norm();
  const double turn = math::log_rotation(input.X_OG.linear() * rest.linear().transpose()).norm();
  if (way <= options_.rest_distance && turn <= 10 * options_.rest_distance) return false;
  rest = input.X_OG;
  return true;
}

bool PoseWrenchFilter::is_settled(const Innovation& now) const noexcept {
  constexpr int kEnough = 80;
  return at_rest_count_ >= kEnough && at_rest_.size() == now.y.size();
}

void PoseWrenchFilter::remember(const Innovation& now) noexcept {
  if (at_rest_count_ > 0 && recent_.size() == now.y.size()) {
    recent_ += kRecent * (now.y - recent_);
    return;
  }
  at_rest_ = recent_ = now.y;
  at_rest_spread_ = WrenchFilter::Wrenches::Zero(now.y.size());
  at_rest_count_ = 1;
}

/// Learns how the wrenches are while nothing happens, and how they spread.
void PoseWrenchFilter::settle() noexcept {
  constexpr int kMost = 200;
  at_rest_count_ = std::min(at_rest_count_ + 1, kMost);
  const WrenchFilter::Wrenches off = recent_ - at_rest_;
  at_rest_ += off / at_rest_count_;
  at_rest_spread_ += (off.cwiseAbs2() - at_rest_spread_) / at_rest_count_;
}

/// What has changed of late since the hands came to rest: a push can be behind it, the sensor's
/// noise, or an object that still swings, which shows in how the wrenches have spread.
PoseWrenchFilter::Innovation PoseWrenchFilter::change(const Innovation& now) const noexcept {
  Innovation result = now;
  result.y = recent_ - at_rest_;
  result.H.leftCols(filter_.contact()).setZero();
  result.R.setZero();
  for (int row = 0; row < result.y.size(); ++row) {
    const double noise = row % 6 < 3 ? options_.force : options_.torque;
    result.R(row, row) = std::max(kRecent / (2 - kRecent) * noise * noise, at_rest_spread_[row]);
  }
  return result;
}

/// Begins to look for a push where the wrenches have changed too much.
void PoseWrenchFilter::watch(const Innovation& changed) noexcept {
  const double test = filter_.test(changed.H, changed.y, changed.R);
  const bool suspicious = test > options_.gate / 6 * static_cast<double>(changed.y.size());
  suspicions_ = suspicious ? suspicions_ + 1 : 0;
  if (suspicions_ >= options_.suspicions && !search_.is_searching())
    search_.begin(changed.y, changed.R, changed.held);
  if (suspicions_ * options_.period > kPatience) at_rest_count_ = 0;  // then that is rest
}

void PoseWrenchFilter::follow_contact(Innovation changed) noexcept {
  changed.R *= (2 - kRecent) / kRecent;  // one mean of late tells little more than the one before
  const double test = filter_.test(changed.H, changed.y, changed.R);
  innovation_test_ = test / static_cast<double>(changed.y.size());
  if (test < 0) return;
  const WrenchFilter::Wrenches alone =
      changed.y + changed.H.rightCols<3>() * filter_.mean().tail<3>();
  const bool believed = test <= options_.gate / 6 * static_cast<double>(changed.y.size());
  suspicions_ = believed ? 0 : suspicions_ + 1;
  if (!believed) unexplained_count_ = 0;  // it has moved
  if (believed) correct(changed);
  constexpr int kMost = 50, kLookAgain = 10;
  if (unexplained_count_ == 0 || unexplained_.size() != alone.size()) unexplained_ = alone;
  unexplained_count_ = std::min(unexplained_count_ + 1, kMost);
  unexplained_ += (alone - unexplained_) / unexplained_count_;
  const bool look = suspicions_ >= options_.suspicions ||
                    (believed && weak_for_ == 0 && unexplained_count_ % kLookAgain == 0);
  if (!look || search_.is_searching()) return;
  // Of a mean's noise little remains, and the model's own error, a share of what the push does.
  WrenchFilter::Noise S = changed.R / unexplained_count_;
  for (int row = 0; row < S.rows(); row += 3) {
    const double error = options_.relative * unexplained_.segment<3>(row).norm();
    S.diagonal().segment<3>(row).array() += error * error;
  }
  search_.begin(unexplained_, S, changed.held);
}

void PoseWrenchFilter::judge_search(const elasticity::DeformationModel& model) noexcept {
  constexpr double kExplained = 0.8;
  constexpr double kClearlyBetter = 1;
  const ContactSearch::Found& found = search_.found();
  if (found.place < 0 || found.share < kExplained || found.force_O.isZero(0)) return;
  if (filter_.has_contact()) {
    if (found.place == place_ || found.cost + kClearlyBetter > search_.judge(place_, model).cost)
      return;
  }
  place_contact(found, model);
}

void PoseWrenchFilter::place_contact(const ContactSearch::Found& found,
                                     const elasticity::DeformationModel& model) noexcept {
  drop_contact(model);
  place_ = found.place;
  filter_.begin_contact(found.force_O, found.covariance);
  push(found.force_O, model);
  suspicions_ = 0;
  weak_for_ = 0;
}

void PoseWrenchFilter::drop_contact(const elasticity::DeformationModel& model) noexcept {
  if (!filter_.has_contact()) return;
  push(-filter_.mean().tail<3>(), model);
  filter_.end_contact();
  place_ = -1;
  unexplained_count_ = 0;
}

/// The prediction follows a change of the force at once.
void PoseWrenchFilter::push(const Eigen::Vector3d& force_O,
                            const elasticity::DeformationModel& model) noexcept {
  int row = 0;
  for (int g = 0; g < filter_.grasp_count(); ++g) {
    if (!model.is_held(g)) continue;
    const math::Vector6d wrench =
        ContactSearch::response(search_.place(place_).point, model.sensitivity(), g) * force_O;
    hands_[g].lagged += wrench;
    if (row + 6 <= recent_.size()) recent_.segment<6>(row) -= wrench;
    row += 6;
  }
}

void PoseWrenchFilter::judge_contact(const elasticity::DeformationModel& model,
                                     double dt) noexcept {
  if (!filter_.has_contact()) return;
  constexpr double kStandsOut = 3;  // deviations
  constexpr double kFadesIn = 0.3;  // s
  const Eigen::Vector3d force = filter_.mean().tail<3>();
  const Eigen::Matrix3d P = filter_.covariance().bottomRightCorner<3, 3>();
  const bool weak = force.dot(P.ldlt().solve(force)) < kStandsOut * kStandsOut;
  weak_for_ = weak ? weak_for_ + dt : 0;
  if (weak_for_ < kFadesIn) return;
  drop_contact(model);
}

}  // namespace palpate::estimation
