#include "core/elasticity/contact/contact_list.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::elasticity {
namespace {

using collision::Candidate;
using Eigen::Vector4d;

// Fraction of the reach by which points may have moved before they are listed again.
constexpr double kRenewal = 0.125;
// A step is expected to move points by no more than this multiple of the last step's motion; where
// it does, look_ahead() completes the points.
constexpr double kExpected = 4;
constexpr double kSpeedChange = 1.5;  // of the reach, beyond which points are listed again

bool is_before(const SurfaceContact& a, const SurfaceContact& b) noexcept {
  return a.sample != b.sample ? a.sample < b.sample : a.obstacle < b.obstacle;
}

/// Grasp patch that contains all nodes of the sample that are not fixed; -1: none.
int patch_of(const NumberedBody& body, const mesh::PointWeights& sample) {
  const factor::BlockPattern& pattern = body.pattern;
  for (int g = 0; g < 2; ++g) {
    const auto is_in = [&](int node) {
      return node >= pattern.size() ||
             (node >= pattern.border_begin(g) && node < pattern.border_end(g));
    };
    if (std::all_of(sample.nodes.begin(), sample.nodes.begin() + sample.count, is_in)) return g;
  }
  return -1;
}

}  // namespace

ContactList::ContactList(const NumberedBody& body, const BoundaryConditions& boundary,
                         const ContactOptions& options,
                         const std::vector<mesh::PointWeights>& samples)
    : body_(body),
      boundary_(boundary),
      options_(options),
      obstacles_(options.obstacles),
      samples_(samples),
      search_(samples, obstacles_,
              std::max(options.reach, options.foresight > 0 ? options.farthest : 0), options.skin),
      x_listed_(body.rest),
      x_begin_(body.rest) {
  for (const mesh::PointWeights& sample : samples_) {
    patch_.push_back(patch_of(body, sample));
    double sum = 0;
    for (int i = 0; i < sample.count; ++i) sum += std::abs(sample.weights[i]);
    weight_sum_ = std::max(weight_sum_, sum);
  }
  contacts_.reserve(options.most);
  close_.reserve(options.most);
  found_.reserve(samples_.size() * obstacles_.size());
}

void ContactList::clear() noexcept {
  contacts_.clear();
  close_.clear();
  listed_ = false;
}

void ContactList::restore(const std::vector<SurfaceContact>& contacts) noexcept {
  clear();
  contacts_.assign(contacts.begin(), contacts.end());
}

/// Upper bound of the motion of a sample between `from` and `x`, m.
double ContactList::travel(const NodalField& x, const NodalField& from) const noexcept {
  Vector4d largest = Vector4d::Zero();
  for (int k = 0; k < body_.pattern.size(); ++k) {
    largest = largest.cwiseMax((x.col(k) - from.col(k)).cwiseAbs());
  }
  return weight_sum_ * largest.norm();
}

void ContactList::evaluate(SurfaceContact& contact, const NodalField& x) const noexcept {
  const mesh::PointWeights& sample = samples_[contact.sample];
  Vector4d p = Vector4d::Zero();
  for (int i = 0; i < sample.count; ++i) p += sample.weights[i] * x.col(sample.nodes[i]);
  contact.position = p.head<3>();
  const collision::Obstacle& obstacle = obstacle_of(contact);
  const collision::Proximity proximity = collision::proximity(obstacle, contact.position);
  contact.gap = proximity.distance;
  contact.normal = proximity.normal;
  const Eigen::Vector3d way = contact.position - obstacle.X_OB * contact.anchor_B;
  contact.slip = way - contact.normal.dot(way) * contact.normal;
}

void ContactList::anchor(SurfaceContact& contact) const noexcept {
  const math::Pose& X_OB = obstacle_of(contact).X_OB;
  contact.anchor_B = X_OB.linear().transpose() * (contact.position - X_OB.translation());
  contact.slip.setZero();
}

void ContactList::place(int obstacle, const collision::Placement& placement) noexcept {
  collision::Obstacle& moved = obstacles_[obstacle];
  if (moved.is_known != placement.is_known || moved.X_OB.matrix() != placement.X_OB.matrix())
    listed_ = false;
  moved.place(placement);
}

/// Distance below which points are listed while no point moves by more than `step` m in a step.
double ContactList::reach_at(double step) const noexcept {
  return std::max(options_.reach,
                  std::min(options_.reach + options_.foresight * step, options_.farthest));
}

/// Sets contacts_ to the points within `reach` m and those under force.
void ContactList::collect(const NodalField& x, double reach) noexcept {
  found_.clear();
  auto known = contacts_.begin();
  for (const Candidate& candidate : search_.find(x.topRows<3>())) {
    // what a hand moves is the hand's concern
    const int patch = patch_[candidate.sample];
    if (patch >= 0 && boundary_.held()[patch]) continue;
    SurfaceContact contact;
    contact.sample = candidate.sample;
    contact.obstacle = candidate.obstacle;
    while (known != contacts_.end() && is_before(*known, contact)) ++known;
    const bool is_known = known != contacts_.end() && !is_before(contact, *known);
    if (is_known) contact = *known;
    evaluate(contact, x);
    contact.gap_when_listed = contact.gap;
    if (contact.gap <= reach || contact.presses()) found_.push_back(contact);
  }
  omitted_ = std::max(0, static_cast<int>(found_.size()) - options_.most);
  if (omitted_ > 0) {
    const auto end = found_.begin() + options_.most;
    std::nth_element(found_.begin(), end, found_.end(),
                     [](const SurfaceContact& a, const SurfaceContact& b) {
                       return a.presses() != b.presses() ? a.presses() : a.gap < b.gap;
                     });
    found_.resize(options_.most);
    std::sort(found_.begin(), found_.end(), is_before);
  }
  contacts_.assign(found_.begin(), found_.end());
  x_listed_ = x;
  held_listed_ = boundary_.held();
  listed_ = true;
  reach_ = reach;
}

/// Sets close_ to the points under force and those that a motion of `ahead` m since they were
/// listed can close, evaluated where the step begins, or already in close_.
void ContactList::select(double ahead) noexcept {
  close_.clear();
  for (int c = 0; c < static_cast<int>(contacts_.size()); ++c) {
    SurfaceContact& contact = contacts_[c];
    if (!contact.presses() && contact.gap_when_listed > ahead) continue;
    close_.push_back(c);
    evaluate(contact, x_begin_);
    if (!contact.presses()) anchor(contact);
  }
  ahead_ = ahead;
}

void ContactList::begin_step(const NodalField& x) noexcept {
  const double step = travel(x, x_begin_);
  double moved = travel(x, x_listed_);
  const double reach = reach_at(step);
  const bool has_speed_changed = reach > kSpeedChange * reach_ || reach_ > kSpeedChange * reach;
  const bool is_stale = !(moved <= kRenewal * reach_) || held_listed_ != boundary_.held();
  if (!listed_ || is_stale || has_speed_changed) {
    collect(x, reach);
    moved = 0;
  }
  x_begin_ = x;
  select(moved + kExpected * step);
}

void ContactList::look_ahead(const NodalField& x, double ahead) noexcept {
  const double needed = travel(x, x_listed_) + weight_sum_ * ahead;
  if (needed > ahead_) select(2 * needed);
}

bool ContactList::contains(int sample) const noexcept {
  const auto at =
      std::lower_bound(contacts_.begin(), contacts_.end(), sample,
                       [](const SurfaceContact& contact, int s) { return contact.sample < s; });
  return at != contacts_.end() && at->sample == sample;
}

}  // namespace palpate::elasticity
