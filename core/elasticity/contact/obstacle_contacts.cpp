#include "core/elasticity/contact/obstacle_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/collision/surface_samples.hpp"
#include "core/math/option_check.hpp"

namespace palpate::elasticity {
namespace {

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

/// Whether the point's force is as large across the normal as friction permits.
bool is_at_limit(const ConePoint& point) {
  const double r_n = point.normal.dot(point.force);
  return (point.force - r_n * point.normal).norm() >= (1 - kAtLimit) * point.friction * r_n;
}

/// The nearest force that friction permits at a surface of this normal.
Vector3d permitted(const Vector3d& force, const Vector3d& normal, double friction) {
  const double r_n = normal.dot(force);
  if (!(r_n > 0)) return Vector3d::Zero();
  const Vector3d r_t = force - r_n * normal;
  const double size = r_t.norm(), most = friction * r_n;
  return size > most ? Vector3d(r_n * normal + (most / size) * r_t) : force;
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
      samples_(samples),
      list_(body, boundary, options_, samples),
      problem_(options.most),
      size_((body.rest.rowwise().maxCoeff() - body.rest.rowwise().minCoeff()).maxCoeff()),
      forward_(Eigen::VectorXf::Zero(3 * body.pattern.size())) {
  for (const mesh::PointWeights& sample : samples_) {
    const auto* largest =
        std::max_element(sample.weights.begin(), sample.weights.begin() + sample.count);
    leading_.push_back(sample.nodes[largest - sample.weights.begin()]);
  }
  points_.reserve(options.most);
  contact_of_.reserve(options.most);
}

void ObstacleContacts::reset() noexcept {
  list_.clear();
  persistence_ = 0;
}

/// Rotation since the factor's snapshot near a sample.
Matrix3d ObstacleContacts::rotation(int sample) const noexcept {
  const NodeWarp& warp = factor_.warp();
  const int node = leading_[sample];
  return node < warp.size() ? Matrix3d(warp.matrix(node).cast<double>()) : Matrix3d::Identity();
}

/// A place of the table that no contact point uses.
int ObstacleContacts::free_place() const noexcept {
  const ComplianceColumns& table = factor_.columns();
  if (!table.is_full()) return table.count();
  for (int place = 0; place < table.count(); ++place) {
    if (!list_.contains(table.sample(place))) return place;
  }
  return -1;
}

/// Computes the compliances of the nearest points without, as many as a step may.
void ObstacleContacts::complete_table() noexcept {
  ComplianceColumns& table = factor_.columns();
  for (int computed = 0; computed < options_.columns; ++computed) {
    const SurfaceContact* nearest = nullptr;
    for (const SurfaceContact& contact : list_.contacts()) {
      if (table.place(contact.sample) >= 0) continue;
      factor_.want_new();  // which brings all of them
      if (contact.gap > options_.imminent) continue;
      if (nearest == nullptr || contact.gap < nearest->gap) nearest = &contact;
    }
    if (nearest == nullptr) return;
    const int place = free_place();
    if (place < 0) return;
    table.add(nearest->sample, place, forward_,
              [&](Eigen::VectorXf& b) { factor_.solve_unturned(b, boundary_); });
    problem_.forget_compliances();
  }
}

/// Fraction of the last step's changes of force that this step is expected to bring: as much as the
/// hands repeat their motion, and as such changes have recurred.
double ObstacleContacts::expected_share() noexcept {
  double alike = 0, before = 0;
  for (int g = 0; g < 2; ++g) {
    math::Vector6d motion = math::Vector6d::Zero();
    if (boundary_.held()[g]) motion = boundary_.pending_motion(g);
    motion.tail<3>() *= size_;
    alike += motion.dot(last_motion_[g]);
    before += last_motion_[g].squaredNorm();
    last_motion_[g] = motion;
  }
  return before > 0 ? persistence_ * std::clamp(alike / before, 0.0, 1.0) : 0;
}

void ObstacleContacts::begin_step(const NodalField& x, StepPotential& potential) noexcept {
  list_.begin_step(x);
  complete_table();
  const double share = expected_share();
  for (int c : list_.close()) {
    SurfaceContact& contact = list_.contact(c);
    contact.force_before = contact.force;
    if (!contact.presses()) continue;
    contact.force = permitted(contact.force + share * contact.last_change, contact.normal,
                              friction_of(contact));
    const mesh::PointWeights& sample = samples_[contact.sample];
    for (int i = 0; i < sample.count; ++i)
      potential.add_external(sample.nodes[i], sample.weights[i] * contact.force);
  }
}

/// Sets points_ to the contacts that the correction can close or that are under force.
void ObstacleContacts::pose_problem(const NodalField& x,
                                    const Eigen::VectorXf& correction) noexcept {
  const ComplianceColumns& table = factor_.columns();
  list_.look_ahead(x, static_cast<double>(correction.lpNorm<Eigen::Infinity>()));
  points_.clear();
  contact_of_.clear();
  double farthest = 0;  // m, motion of a point by the correction
  for (int c : list_.close()) {
    SurfaceContact& contact = list_.contact(c);
    const int place = table.place(contact.sample);
    if (place < 0) continue;  // not yet
    list_.evaluate(contact, x);
    const mesh::PointWeights& sample = samples_[contact.sample];
    Vector3d motion = Vector3d::Zero();
    for (int i = 0; i < sample.count; ++i) {
      if (sample.nodes[i] >= body_.pattern.size()) continue;
      motion += sample.weights[i] * correction.segment<3>(3 * sample.nodes[i]).cast<double>();
    }
    farthest = std::max(farthest, motion.norm());
    ConePoint& point = points_.emplace_back();
    point.place = place;
    point.normal = contact.normal;
    point.friction = friction_of(contact);
    point.offset = contact.gap * contact.normal + contact.slip + motion;
    point.force = contact.force;
    contact_of_.push_back(c);
  }
  // Contact forces oppose the correction and move points about as far: what remains farther from
  // the obstacle than that stays open, or is found open to change in the next correction.
  std::size_t kept = 0;
  for (std::size_t k = 0; k < points_.size(); ++k) {
    ConePoint point = points_[k];
    if (point.force.isZero(0) && point.normal.dot(point.offset) > farthest) continue;
    const Matrix3d back = rotation(list_.contacts()[contact_of_[k]].sample).transpose();
    point.normal = back * point.normal;
    point.offset = back * point.offset;
    point.force = back * point.force;
    contact_of_[kept] = contact_of_[k];
    points_[kept++] = point;
  }
  points_.resize(kept);
  contact_of_.resize(kept);
}

double ObstacleContacts::correct(const NodalField& x, Eigen::VectorXf& correction,
                                 StepPotential& potential) noexcept {
  pose_problem(x, correction);
  if (points_.empty()) return 0;
  const ComplianceColumns& table = factor_.columns();
  problem_.solve(table, {options_.sweeps, 0.1 * options_.tolerance}, points_);

  double energy = 0;
  forward_.setZero();
  bool changed = false;
  for (std::size_t k = 0; k < points_.size(); ++k) {
    SurfaceContact& contact = list_.contact(contact_of_[k]);
    const Matrix3d turn = rotation(contact.sample);
    const Vector3d change = turn * points_[k].force - contact.force;
    contact.at_limit = is_at_limit(points_[k]);
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
  list_.look_ahead(x, 0);
  for (int c : list_.close()) {
    SurfaceContact& contact = list_.contact(c);
    list_.evaluate(contact, x);
    largest = std::max(largest, contact.presses() ? std::abs(contact.gap) : -contact.gap);
    if (!contact.presses()) continue;
    const double slip = contact.slip.norm();
    const Vector3d friction = contact.force - contact.normal_force() * contact.normal;
    if (!contact.at_limit)
      largest = std::max(largest, slip);
    else if (friction_of(contact) > 0)
      largest = std::max(largest, (contact.slip + slip * friction.normalized()).norm());
  }
  return largest;
}

bool ObstacleContacts::is_touching() const noexcept {
  const std::vector<SurfaceContact>& all = list_.contacts();
  return std::any_of(all.begin(), all.end(),
                     [](const SurfaceContact& contact) { return contact.presses(); });
}

double ObstacleContacts::farthest() const noexcept {
  return is_touching() ? options_.reach : std::numeric_limits<double>::infinity();
}

void ObstacleContacts::describe(std::vector<int>& samples, Snapshot& snapshot) const noexcept {
  std::vector<TouchingPoint>& touching = snapshot.touching;
  samples.clear();
  touching.clear();
  for (const SurfaceContact& contact : list_.contacts()) {
    if (samples.empty() || samples.back() != contact.sample) samples.push_back(contact.sample);
    if (!contact.presses()) continue;
    const mesh::PointWeights& sample = samples_[contact.sample];
    TouchingPoint& point = touching.emplace_back();
    for (int i = 0; i < sample.count; ++i) {
      if (sample.nodes[i] >= body_.pattern.size()) continue;
      point.point.nodes[point.point.count] = body_.pattern.node(sample.nodes[i]);
      point.point.weights[point.point.count++] = sample.weights[i];
    }
    const collision::Obstacle& obstacle = list_.obstacle_of(contact);
    point.obstacle = contact.obstacle;
    snapshot.obstacles[static_cast<std::size_t>(contact.obstacle)] = obstacle.X_OB;
    point.hand = obstacle.hand;
    point.position = contact.position;
    point.slips = contact.slips;
    point.normal = contact.normal;
    point.force = contact.force;
    if (contact.slips)
      point.normal_derivative = collision::normal_derivative(obstacle, contact.position);
  }
}

void ObstacleContacts::finish_step(const NodalField& x) noexcept {
  double alike = 0, before = 0;
  for (int c : list_.close()) {
    SurfaceContact& contact = list_.contact(c);
    const Vector3d change = contact.force - contact.force_before;
    alike += change.dot(contact.last_change);
    before += contact.last_change.squaredNorm();
    // a point that has just closed will not change as much again
    contact.last_change = contact.force_before.isZero(0) ? Vector3d(Vector3d::Zero()) : change;
    const bool slipped = contact.slips, pressed = contact.pressed;
    contact.pressed = contact.presses();
    contact.slips = contact.pressed && contact.at_limit;
    if (contact.pressed) list_.evaluate(contact, x);
    if (contact.slips) list_.anchor(contact);
    // the response of the equilibrium has changed
    if (contact.pressed != pressed || contact.slips != slipped) factor_.want_new();
  }
  persistence_ = before > 0 ? std::clamp(alike / before, 0.0, 1.0) : 0;
}

}  // namespace palpate::elasticity
