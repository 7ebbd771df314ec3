#include "core/elasticity/corotational_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "core/math/option_check.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

const Body& checked(const Body& body) {
  body.check();
  return body;
}

std::vector<int> elimination_numbering(const factor::BlockPattern& pattern) {
  std::vector<int> numbering(pattern.node_count());
  int next = pattern.size();
  for (int node = 0; node < pattern.node_count(); ++node) {
    numbering[node] = pattern.unknown(node) >= 0 ? pattern.unknown(node) : next++;
  }
  return numbering;
}

}  // namespace

CorotationalModel::CorotationalModel(Body body, const SolverOptions& options, Mechanics mechanics)
    : body_(checked(body)),
      options_(options),
      dynamic_(mechanics == Mechanics::kDynamic),
      elements_(body_),
      pattern_(body_.mesh.elements, body_.mesh.node_count(), body_.fixed_nodes, patches(body_)),
      supernodes_(pattern_),
      numbering_(elimination_numbering(pattern_)),
      element_forces_(make_element_forces(body_.mesh, elements_.materials(), numbering_,
                                          options.precision, team())),
      rounding_(options.precision == Precision::kSingle ? 1e-6 : 1e-12),
      gravity_(body_.gravity_O),
      positions_(body_.mesh.nodes),
      correction_(Eigen::VectorXf::Zero(3 * pattern_.size())),
      step_taken_(correction_),
      force_change_(correction_),
      secants_(3 * pattern_.size()),
      warp_(pattern_.size()),
      factor_(supernodes_, options.panels, team()),
      job_(body_, elements_, supernodes_, options.panels, team()),
      blend_(body_) {
  using math::check_option;
  check_option(options.iterations >= 1, "iterations", options.iterations, "at least 1");
  check_option(options.halvings >= 0, "halvings", options.halvings, "at least 0");
  check_option(options.tolerance > 0, "tolerance", options.tolerance, "above 0");
  check_option(options.accuracy >= 0, "accuracy", options.accuracy, "at least 0");
  check_option(options.time_step > 0, "time_step", options.time_step, "above 0");
  check_option(options.turned > 0, "turned", options.turned, "above 0");
  check_option(options.contraction > 0, "contraction", options.contraction, "above 0");
  check_option(options.budget >= 0, "budget", options.budget, "at least 0");
  check_option(options.refine >= 0, "refine", options.refine, "at least 0");
  if (!dynamic_ && options.refine > 0) {
    tangent_.emplace(body_, elements_.materials(), numbering_, options.precision);
  }
  if (dynamic_) inertia_.emplace(elements_, numbering_, team());
  const int n = body_.mesh.node_count();
  loads_ = velocities_ = Matrix3Xd::Zero(3, n);
  for (NodalField* m :
       {&weight_per_gravity_, &rest_, &external_, &v_, &prediction_error_, &column_, &x_inertial_,
        &x_expected_, &x_trial_, &x_kept_, &forces_, &forces_trial_}) {
    m->setZero(4, n);
  }
  for (int node = 0; node < n; ++node) {
    rest_.col(numbering_[node]).head<3>() = body_.mesh.nodes.col(node);
    weight_per_gravity_.col(numbering_[node]).setConstant(elements_.nodal_mass()(node));
  }
  weight_per_gravity_.row(3).setZero();
  x_ = x_begin_ = rest_;
  rotations_.setZero(4, n);
  rotations_.row(0).setOnes();
  factor_.rotations = job_.factor.rotations = rotations_;
  sensitivity_.resize(n);
  at_snapshot_.resize(n);
}

StepFactors CorotationalModel::step_factors(double dt) const noexcept {
  if (!dynamic_) return {};
  return {1 / (dt * dt) + body_.damping.mass_factor / dt, body_.damping.stiffness_factor / dt};
}

void CorotationalModel::prepare() {
  reset();
  gravity_ = body_.gravity_O;
  step_ = step_factors(options_.time_step);
  outstanding_ = false;
  wanted_ = true;
  Refactorisation* job = wanted_refactorisation();
  job->run();
  install(*job);
}

void CorotationalModel::reset() noexcept {
  x_ = rest_;
  v_.setZero();
  prediction_error_.setZero();
  reach_ = kFar;
  loads_.setZero();
  forces_.setZero();
  elastic_ = 0;
  held_ = {false, false};
  element_forces_->reset();
  rotations_.setZero();
  rotations_.row(0).setOnes();
  warp_.update(rotations_, factor_.rotations);
  sensitivity_.valid = at_snapshot_.valid = false;
  secants_.clear();
  suspect_count_ = 0;
  inverted_ = torn_ = false;
  wanted_ = true;
  publish();
}

void CorotationalModel::hold(int grasp, const math::Pose& X_OG) noexcept {
  Grasp& g = grasps_[grasp];
  g.target = X_OG;
  if (held_[grasp]) return;
  held_[grasp] = true;
  g.applied = grasp_pose(body_, grasp, positions_);
  sensitivity_.valid = at_snapshot_.valid = false;
  secants_.clear();
  contraction_ = 1;
  wanted_ = true;
}

void CorotationalModel::release(int grasp) noexcept {
  if (!held_[grasp]) return;
  held_[grasp] = false;
  sensitivity_.valid = at_snapshot_.valid = false;
  secants_.clear();
  contraction_ = 1;
  wanted_ = true;
}

void CorotationalModel::watch_contact(int slot, const mesh::PointWeights& point) noexcept {
  contacts_[slot] = point;
  wanted_ = true;
}

void CorotationalModel::follow_rotations() noexcept {
  element_forces_->node_rotations(rotations_);
  warp_.update(rotations_, factor_.rotations);
  if (warp_.largest() > options_.turned) wanted_ = true;
}

void CorotationalModel::turn_sensitivity(int begin, int end) noexcept {
  if (!at_snapshot_.valid) return;
  Turned turned{warp_, numbering_};
  for (int g = 0; g < 2; ++g) {
    turned.is_held[g] = held_[g];
    turned.grasps[g] = grasps_[g].applied.linear() * grasps_[g].snapshot.linear().transpose();
  }
  for (int c = 0; c < kContactSlots; ++c) {
    // the node with the largest weight determines the rotation of a contact
    const mesh::PointWeights& point = contacts_[c];
    const auto* largest =
        std::max_element(point.weights.begin(), point.weights.begin() + point.count);
    const int k = point.count > 0 ? numbering_[point.nodes[largest - point.weights.begin()]] : -1;
    turned.is_watched[c] = point.count > 0;
    turned.contacts[c].setIdentity();
    if (k >= 0 && k < warp_.size()) turned.contacts[c] = warp_.matrix(k).cast<double>();
  }
  turn(at_snapshot_, turned, begin, end, sensitivity_);
}

void CorotationalModel::publish() noexcept {
  for (int node = 0; node < positions_.cols(); ++node) {
    positions_.col(node) = x_.col(numbering_[node]).head<3>();
    velocities_.col(node) = v_.col(numbering_[node]).head<3>();
  }
}

math::Wrench CorotationalModel::reaction(int grasp) const noexcept {
  math::Wrench wrench;
  if (!held_[grasp]) return wrench;
  const Vector3d origin = grasps_[grasp].applied.translation();
  for (int node : body_.grasps[grasp].nodes) {
    const Vector3d force = forces_.col(numbering_[node]).head<3>();
    wrench.force += force;
    wrench.torque += (positions_.col(node) - origin).cross(force);
  }
  return wrench;
}

Refactorisation* CorotationalModel::wanted_refactorisation() noexcept {
  if (outstanding_ || (!wanted_ && factor_.usable)) return nullptr;
  Snapshot& snapshot = job_.snapshot;
  snapshot.positions = positions_;
  snapshot.loads = loads_;
  snapshot.gravity_O = gravity_;
  snapshot.held = held_;
  snapshot.contacts = contacts_;
  for (int g = 0; g < 2; ++g) {
    snapshot.origins[g] = grasps_[g].applied.translation();
    job_grasps_[g] = grasps_[g].applied;
  }
  element_forces_->node_rotations(rotations_);
  job_.factor.rotations = rotations_;
  job_.factor.step = step_;
  job_age_ = 0;
  outstanding_ = true;
  wanted_ = false;
  return &job_;
}

void CorotationalModel::install(Refactorisation& done) noexcept {
  if (&done != &job_ || !outstanding_) return;
  outstanding_ = false;
  if (!job_.factor.usable || !job_.factor.panels.usable(held_)) {
    wanted_ = true;
    return;
  }
  std::swap(factor_, job_.factor);
  factor_age_ = job_age_;
  secants_.clear();
  follow_rotations();
  if (job_.snapshot.held != held_) return;
  std::swap(at_snapshot_, job_.sensitivity);
  std::swap(sensitivity_.stress, at_snapshot_.stress);
  for (int g = 0; g < 2; ++g) grasps_[g].snapshot = job_grasps_[g];
  sensitivity_.valid = at_snapshot_.valid;
  sensitivity_.age = job_age_;
  if (!dynamic_) persistence_ = 0;  // errors of the old sensitivity no longer apply
  turn_sensitivity(0, static_cast<int>(positions_.cols()));
}

bool CorotationalModel::restore(const Matrix3Xd& positions, const Matrix3Xd& velocities) noexcept {
  if (positions.cols() != x_.cols() || velocities.cols() != x_.cols() || !positions.allFinite() ||
      !velocities.allFinite()) {
    return false;
  }
  for (int node = 0; node < positions.cols(); ++node) {
    const int k = numbering_[node];
    const bool fixed = k >= pattern_.size();
    x_.col(k).head<3>() =
        fixed ? Vector3d(body_.mesh.nodes.col(node)) : Vector3d(positions.col(node));
    v_.col(k).head<3>() = fixed || !dynamic_ ? Vector3d::Zero() : Vector3d(velocities.col(node));
  }
  publish();
  for (int g = 0; g < 2; ++g) {
    if (held_[g]) grasps_[g].applied = grasp_pose(body_, g, positions_);
  }
  prediction_error_.setZero();
  // strains and rotations of the new shape, from which the next step starts
  forces_.setZero();
  elastic_ = element_forces_->add(x_, 0, forces_);
  secants_.clear();
  wanted_ = true;
  suspect_count_ = 0;
  inverted_ = torn_ = false;
  ticks_ = kTanglePeriod - 1;  // the next step checks whether the shape is valid
  follow_rotations();
  return true;
}

RigidBlend::RigidBlend(const Body& body)
    : rest_(body.mesh.nodes),
      distance2_(Eigen::Matrix3Xd::Constant(3, rest_.cols(), std::numeric_limits<double>::max())) {
  const auto measure = [&](int row, const std::vector<int>& nodes) {
    for (int i = 0; i < rest_.cols(); ++i) {
      for (int node : nodes) {
        const double d = (rest_.col(i) - rest_.col(node)).squaredNorm();
        distance2_(row, i) = std::min(distance2_(row, i), d);
      }
    }
  };
  for (std::size_t g = 0; g < body.grasps.size(); ++g) {
    measure(static_cast<int>(g), body.grasps[g].nodes);
  }
  measure(2, body.fixed_nodes);
}

Eigen::Vector3d RigidBlend::position(int node, const std::array<bool, 2>& held,
                                     const std::array<math::Pose, 2>& motions) const noexcept {
  const Eigen::Vector3d at_rest = rest_.col(node);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double weights = 0;
  for (int k = 0; k < 3; ++k) {
    const bool present = k == 2 || held[k];
    if (!present || distance2_(k, node) == std::numeric_limits<double>::max()) continue;
    const double weight = 1 / std::max(distance2_(k, node), 1e-18);
    sum += weight * (k == 2 ? at_rest : Eigen::Vector3d(motions[k] * at_rest));
    weights += weight;
  }
  return weights > 0 ? Eigen::Vector3d(sum / weights) : at_rest;
}

}  // namespace palpate::elasticity
