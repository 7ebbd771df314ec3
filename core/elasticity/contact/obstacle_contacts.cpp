#include "core/elasticity/contact/obstacle_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/collision/surface_samples.hpp"
#include "core/math/option_check.hpp"

namespace palpate::elasticity {
namespace {

using collision::Candidate;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kAtLimit = 1e-6;  // relative, of the limit of friction

const ContactOptions& checked(const ContactOptions& options) {
  using math::check_option;
  for (const collision::Obstacle& obstacle : options.obstacles) obstacle.check();
  check_option(options.obstacles.size() <= collision::kMostObstacles, "obstacles",
               options.obstacles.size(), "at most " + std::to_string(collision::kMostObstacles));
  check_option(options.most >= 1, "most", options.most, "at least 1");
  check_option(options.reach > 0, "reach", options.reach, "above 0");
  check_option(options.skin > 0, "skin", options.skin, "above 0");
  check_option(options.columns >= 1, "columns", options.columns, "at least 1");
  check_option(options.sweeps >= 1, "sweeps", options.sweeps, "at least 1");
  check_option(options.tolerance > 0, "tolerance", options.tolerance, "above 0");
  return options;
}

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

std::vector<mesh::PointWeights> ObstacleContacts::numbered_samples(const NumberedBody& body,
                                                                   const ContactOptions& options) {
  if (options.obstacles.empty()) return {};
  const mesh::ElementMesh& mesh = body.body.mesh;
  double spacing = std::numeric_limits<double>::infinity();
  for (const collision::Obstacle& obstacle : options.obstacles)
    spacing = std::min(spacing, collision::sample_spacing(obstacle));
  std::vector<mesh::PointWeights> samples =
      collision::surface_samples(mesh::extract_surface(mesh), mesh.nodes, spacing);
  for (mesh::PointWeights& sample : samples) {
    for (int i = 0; i < sample.count; ++i) sample.nodes[i] = body.numbering[sample.nodes[i]];
  }
  // points that cannot move are the support's concern
  const auto is_fixed = [&](const mesh::PointWeights& sample) {
    return std::all_of(sample.nodes.begin(), sample.nodes.begin() + sample.count,
                       [&](int node) { return node >= body.pattern.size(); });
  };
  samples.erase(std::remove_if(samples.begin(), samples.end(), is_fixed), samples.end());
  return samples;
}

ObstacleContacts::ObstacleContacts(const NumberedBody& body, const BoundaryConditions& boundary,
                                   WarpedFactor& factor, const ContactOptions& options,
                                   const std::vector<mesh::PointWeights>& samples)
    : body_(body),
      boundary_(boundary),
      factor_(factor),
      options_(checked(options)),
      obstacles_(options.obstacles),
      samples_(samples),
      search_(samples, obstacles_, options.reach, options.skin),
      problem_(options.most),
      forward_(Eigen::VectorXf::Zero(3 * body.pattern.size())) {
  for (const mesh::PointWeights& sample : samples_) {
    const auto* largest =
        std::max_element(sample.weights.begin(), sample.weights.begin() + sample.count);
    leading_.push_back(sample.nodes[largest - sample.weights.begin()]);
    patch_.push_back(patch_of(body, sample));
  }
  contacts_.reserve(options.most);
  found_.reserve(samples_.size() * obstacles_.size());
  points_.reserve(options.most);
  contact_of_.reserve(options.most);
}

/// Rotation since the factor's snapshot near a sample.
Matrix3d ObstacleContacts::rotation(int sample) const noexcept {
  const NodeWarp& warp = factor_.warp();
  const int node = leading_[sample];
  return node < warp.size() ? Matrix3d(warp.matrix(node).cast<double>()) : Matrix3d::Identity();
}

void ObstacleContacts::evaluate(SurfaceContact& contact, const NodalField& x) const noexcept {
  const collision::Obstacle& obstacle = obstacles_[contact.obstacle];
  contact.position = collision::position(samples_[contact.sample], x.topRows<3>());
  contact.normal = collision::normal(obstacle, contact.position);
  contact.gap = collision::distance(obstacle, contact.position);
  const Vector3d way = contact.position - obstacle.X_OB * contact.anchor_B;
  contact.slip = way - contact.normal.dot(way) * contact.normal;
}

/// Slip counts from the present position on.
void ObstacleContacts::anchor(SurfaceContact& contact) const noexcept {
  const math::Pose& X_OB = obstacles_[contact.obstacle].X_OB;
  contact.anchor_B = X_OB.linear().transpose() * (contact.position - X_OB.translation());
  contact.slip.setZero();
}

/// Sets contacts_ to the points within reach and those under force.
void ObstacleContacts::collect(const NodalField& x) noexcept {
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
    if (!is_known) anchor(contact);
    if (contact.gap <= options_.reach || contact.presses()) found_.push_back(contact);
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
}

/// A place of the table that no contact point uses.
int ObstacleContacts::free_place() const noexcept {
  const ComplianceColumns& table = factor_.columns();
  if (!table.is_full()) return table.count();
  for (int place = 0; place < table.count(); ++place) {
    const int sample = table.sample(place);
    const auto at =
        std::lower_bound(contacts_.begin(), contacts_.end(), sample,
                         [](const SurfaceContact& contact, int s) { return contact.sample < s; });
    if (at == contacts_.end() || at->sample != sample) return place;
  }
  return -1;
}

/// Computes the compliances of the nearest points without, as many as a step may.
void ObstacleContacts::complete_table() noexcept {
  ComplianceColumns& table = factor_.columns();
  for (int computed = 0; computed < options_.columns; ++computed) {
    const SurfaceContact* nearest = nullptr;
    for (const SurfaceContact& contact : contacts_) {
      if (table.place(contact.sample) >= 0 || contact.gap > options_.imminent) continue;
      if (nearest == nullptr || contact.gap < nearest->gap) nearest = &contact;
    }
    if (nearest == nullptr) return;
    factor_.want_new();  // which brings all of them
    const int place = free_place();
    if (place < 0) return;
    table.add(nearest->sample, place, forward_,
              [&](Eigen::VectorXf& b) { factor_.solve_unturned(b, boundary_); });
  }
}

void ObstacleContacts::begin_step(const NodalField& x, StepPotential& potential) noexcept {
  collect(x);
  complete_table();
  for (const SurfaceContact& contact : contacts_) {
    if (!contact.presses()) continue;
    const mesh::PointWeights& sample = samples_[contact.sample];
    for (int i = 0; i < sample.count; ++i)
      potential.add_external(sample.nodes[i], sample.weights[i] * contact.force);
  }
}

double ObstacleContacts::correct(const NodalField& x, Eigen::VectorXf& correction,
                                 StepPotential& potential) noexcept {
  const ComplianceColumns& table = factor_.columns();
  points_.clear();
  contact_of_.clear();
  for (int c = 0; c < static_cast<int>(contacts_.size()); ++c) {
    SurfaceContact& contact = contacts_[c];
    const int place = table.place(contact.sample);
    if (place < 0) continue;  // not yet
    evaluate(contact, x);
    const mesh::PointWeights& sample = samples_[contact.sample];
    Vector3d offset = contact.gap * contact.normal + contact.slip;
    for (int i = 0; i < sample.count; ++i) {
      if (sample.nodes[i] >= body_.pattern.size()) continue;
      offset += sample.weights[i] * correction.segment<3>(3 * sample.nodes[i]).cast<double>();
    }
    const Matrix3d back = rotation(contact.sample).transpose();
    ConePoint& point = points_.emplace_back();
    point.place = place;
    point.normal = back * contact.normal;
    point.friction = obstacles_[contact.obstacle].friction;
    point.offset = back * offset;
    point.force = back * contact.force;
    contact_of_.push_back(c);
  }
  if (points_.empty()) return 0;
  problem_.solve(table, {options_.sweeps, 0.1 * options_.tolerance}, points_);

  double energy = 0;
  forward_.setZero();
  bool changed = false;
  for (std::size_t k = 0; k < points_.size(); ++k) {
    SurfaceContact& contact = contacts_[contact_of_[k]];
    const Matrix3d turn = rotation(contact.sample);
    const Vector3d change = turn * points_[k].force - contact.force;
    if (!change.allFinite() || change.isZero(0)) continue;
    changed = true;
    contact.force += change;
    if (points_[k].force.isZero(0)) contact.force.setZero();
    forward_.noalias() +=
        table.response(points_[k].place) * (turn.transpose() * change).cast<float>();
    const mesh::PointWeights& sample = samples_[contact.sample];
    for (int i = 0; i < sample.count; ++i) {
      const int node = sample.nodes[i];
      const Vector3d force = sample.weights[i] * change;
      potential.add_external(node, force);
      energy -= force.dot((x.col(node) - body_.rest.col(node)).head<3>());
    }
  }
  if (!changed) return 0;
  factor_.warp().turn(forward_);
  boundary_.clear_held_nodes(forward_);
  correction += forward_;
  return energy;
}

double ObstacleContacts::violation(const NodalField& x) noexcept {
  double largest = 0;
  for (SurfaceContact& contact : contacts_) {
    evaluate(contact, x);
    const double r_n = contact.normal_force();
    largest = std::max(largest, contact.presses() ? std::abs(contact.gap) : -contact.gap);
    if (!contact.presses()) continue;
    const double limit = obstacles_[contact.obstacle].friction * r_n;
    const Vector3d friction = contact.force - r_n * contact.normal;
    const double slip = contact.slip.norm();
    if (friction.norm() < (1 - kAtLimit) * limit) {
      largest = std::max(largest, slip);
    } else if (limit > 0) {
      largest = std::max(largest, (contact.slip + slip * friction.normalized()).norm());
    }
  }
  return largest;
}

bool ObstacleContacts::is_touching() const noexcept {
  return std::any_of(contacts_.begin(), contacts_.end(),
                     [](const SurfaceContact& contact) { return contact.presses(); });
}

void ObstacleContacts::describe(std::vector<int>& samples,
                                std::vector<TouchingPoint>& touching) const noexcept {
  samples.clear();
  touching.clear();
  for (const SurfaceContact& contact : contacts_) {
    if (samples.empty() || samples.back() != contact.sample) samples.push_back(contact.sample);
    if (!contact.presses()) continue;
    const mesh::PointWeights& sample = samples_[contact.sample];
    TouchingPoint& point = touching.emplace_back();
    for (int i = 0; i < sample.count; ++i) {
      if (sample.nodes[i] >= body_.pattern.size()) continue;
      point.point.nodes[point.point.count] = body_.pattern.node(sample.nodes[i]);
      point.point.weights[point.point.count++] = sample.weights[i];
    }
    point.obstacle = contact.obstacle;
    point.hand = obstacles_[contact.obstacle].hand;
    point.position = contact.position;
    point.slips = contact.slips;
    point.normal = contact.normal;
    point.force = contact.force;
    if (contact.slips) {
      point.normal_derivative =
          collision::normal_derivative(obstacles_[contact.obstacle], contact.position);
    }
  }
}

void ObstacleContacts::finish_step(const NodalField& x) noexcept {
  for (SurfaceContact& contact : contacts_) {
    evaluate(contact, x);
    const double r_n = contact.normal_force();
    const double limit = obstacles_[contact.obstacle].friction * r_n;
    const bool slipped = contact.slips, pressed = contact.pressed;
    contact.pressed = contact.presses();
    contact.slips = contact.presses() &&
                    (contact.force - r_n * contact.normal).norm() >= (1 - kAtLimit) * limit;
    if (!contact.presses() || contact.slips) anchor(contact);
    // the response of the equilibrium has changed
    if (contact.pressed != pressed || contact.slips != slipped) factor_.want_new();
  }
}

}  // namespace palpate::elasticity
