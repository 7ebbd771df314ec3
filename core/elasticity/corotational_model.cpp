#include "core/elasticity/corotational_model.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "core/elasticity/grasp_pose.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

// Rotations of nodes are looked at once in so many steps, in which they change by some hundredths
// of a radian; the sensitivity is turned with them piece by piece in between.
constexpr int kLookPeriod = 4;
// Inside-out elements are looked for once in so many steps; after so many looks in a row that find
// some, or one that finds a tenth of the body like that, the shape is given up.
constexpr int kTanglePeriod = 16;
constexpr int kPatience = 12;
constexpr int kHopelessShare = 10;

const Body& checked(const Body& body) {
  body.check();
  return body;
}

std::vector<int> elimination_numbering(const BlockPattern& pattern) {
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
      element_forces_(
          make_element_forces(body_.mesh, elements_.materials(), numbering_, options.precision)),
      rounding_(options.precision == Precision::kSingle ? 1e-6 : 1e-12),
      gravity_(body_.gravity_O),
      positions_(body_.mesh.nodes),
      correction_(Eigen::VectorXf::Zero(3 * pattern_.size())),
      step_taken_(correction_),
      force_change_(correction_),
      secants_(3 * pattern_.size()),
      warp_(pattern_.size()),
      factor_(supernodes_, options.panels),
      job_(body_, elements_, supernodes_, options.panels),
      blend_(body_) {
  if (options.iterations < 1 || options.halvings < 0 || !(options.tolerance > 0) ||
      !(options.accuracy >= 0) || !(options.time_step > 0) || !(options.turned > 0) ||
      !(options.contraction > 0) || !(options.budget >= 0)) {
    throw std::invalid_argument("solver options: a value is out of range");
  }
  if (dynamic_) inertia_.emplace(elements_, numbering_);
  const int n = body_.mesh.node_count();
  loads_ = velocities_ = Matrix3Xd::Zero(3, n);
  for (NodalField* m : {&weight_per_gravity_, &rest_, &external_, &v_, &x_inertial_, &x_trial_,
                        &x_kept_, &forces_, &forces_trial_}) {
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
  tangled_ = 0;
  untangled_ = false;
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
  wanted_ = true;
}

void CorotationalModel::release(int grasp) noexcept {
  if (!held_[grasp]) return;
  held_[grasp] = false;
  sensitivity_.valid = at_snapshot_.valid = false;
  secants_.clear();
  wanted_ = true;
}

void CorotationalModel::watch_contact(int slot, const mesh::PointWeights& point) noexcept {
  contacts_[slot] = point;
  wanted_ = true;
}

bool CorotationalModel::inputs_are_finite() const noexcept {
  if (!loads_.allFinite() || !gravity_.allFinite()) return false;
  for (int g = 0; g < 2; ++g) {
    if (held_[g] && !grasps_[g].target.matrix().allFinite()) return false;
  }
  return true;
}

bool CorotationalModel::out_of_time(double start) const noexcept {
  return options_.clock != nullptr && options_.clock() - start > options_.budget;
}

StepReport CorotationalModel::step(double dt) noexcept {
  StepReport report;
  const double start = options_.clock != nullptr ? options_.clock() : 0;
  if (!(dt > 0) || !factor_.usable || !factor_.panels.usable(held_) || !inputs_are_finite()) {
    report.residual = residual();
    return report;
  }
  const std::array<Grasp, 2> grasps_begin = grasps_;
  step_ = step_factors(dt);
  // A factor made for a quite different step would contract slowly.
  if (dynamic_ && std::abs(step_.inertia / factor_.step.inertia - 1) > 0.3) wanted_ = true;
  for (int node = 0; node < loads_.cols(); ++node) {
    external_.col(numbering_[node]).head<3>() = loads_.col(node);
  }
  external_.topRows<3>() += gravity_.asDiagonal() * weight_per_gravity_.topRows<3>();
  x_begin_ = x_;
  element_forces_->begin_step();
  elastic_begin_ = elastic_;
  dt_ = dt;

  predict(dt, true);
  double energy = evaluate();
  if (!std::isfinite(energy) || !forces_.allFinite()) {
    predict(dt, false);
    energy = evaluate();
  }
  if (std::isfinite(energy) && forces_.allFinite()) {
    if (++ticks_ % kLookPeriod == 0) follow_rotations();
    if (ticks_ % kTanglePeriod == 0 && untangle()) energy = evaluate();
    const double initial = residual();
    correct(report, energy, start);
    if (dynamic_ && report.residual > 0.05 * initial && energy > potential_of_staying()) {
      stay_if_better(report, energy, dt, start);
    }
    if (tangled_ > 0 && report.status == StepStatus::kConverged) {
      report.status = StepStatus::kNotConverged;
    }
  } else {
    x_ = x_begin_;
    grasps_ = grasps_begin;
    evaluate();
    if (!forces_.allFinite()) forces_.setZero();
    wanted_ = true;
  }
  if (report.status != StepStatus::kFailed && dynamic_) v_ = (x_ - x_begin_) / dt;
  publish();
  sensitivity_.age += dt;
  factor_age_ += dt;
  job_age_ += dt;
  const auto n = static_cast<int>(positions_.cols());
  const int part = ticks_ % kLookPeriod;
  turn_sensitivity(n * part / kLookPeriod, n * (part + 1) / kLookPeriod);
  return report;
}

void CorotationalModel::predict(double dt, bool follow) noexcept {
  x_ = x_begin_;
  if (dynamic_) {
    x_inertial_ = x_begin_ + v_ * (1 / (dt * step_.inertia));
    if (follow) x_ += dt * v_;
  }
  const auto grasps = static_cast<int>(body_.grasps.size());
  for (int g = 0; g < grasps && follow && !dynamic_ && sensitivity_.valid; ++g) {
    if (!held_[g]) continue;
    const Grasp& grasp = grasps_[g];
    math::Vector6d motion;
    motion << grasp.target.translation() - grasp.applied.translation(),
        math::log_rotation(grasp.target.linear() * grasp.applied.linear().transpose());
    if (motion.isZero(0)) continue;
    for (int node = 0; node < positions_.cols(); ++node) {
      x_.col(numbering_[node]).head<3>() +=
          sensitivity_.dx_dxi[g].middleRows<3>(3 * node).lazyProduct(motion);
    }
  }
  for (int g = 0; g < grasps; ++g) {
    if (!held_[g]) continue;
    grasps_[g].applied = grasps_[g].target;
    const math::Pose moved = grasps_[g].target * body_.grasps[g].X_OG_rest.inverse();
    for (int node : body_.grasps[g].nodes) {
      x_.col(numbering_[node]).head<3>() = moved * body_.mesh.nodes.col(node);
    }
  }
}

/// Potential at x_ in J; leaves its derivative, the forces out of balance, in forces_.
double CorotationalModel::evaluate() noexcept {
  forces_ = -external_;
  double energy = -external_.cwiseProduct(x_ - rest_).sum();
  elastic_ = element_forces_->add(x_, step_.viscous, forces_);
  energy += elastic_;
  if (dynamic_) energy += inertia_->add(x_, x_inertial_, step_.inertia, forces_);
  return energy;
}

/// Largest force out of balance at a free node, N.
double CorotationalModel::residual() const noexcept {
  double largest = 0;
  for (int k = 0; k < pattern_.interior_size(); ++k) {
    largest = std::max(largest, forces_.col(k).squaredNorm());
  }
  for (int g = 0; g < 2; ++g) {
    for (int k = pattern_.border_begin(g); k < pattern_.border_end(g) && !held_[g]; ++k) {
      largest = std::max(largest, forces_.col(k).squaredNorm());
    }
  }
  return std::sqrt(largest);
}

/// Into correction_; returns the slope of the potential along it, J.
double CorotationalModel::find_correction() noexcept {
  const int unknowns = pattern_.size();
  for (int k = 0; k < unknowns; ++k) {
    correction_.segment<3>(3 * k) = -forces_.col(k).head<3>().cast<float>();
  }
  for (int g = 0; g < 2; ++g) {
    const int begin = pattern_.border_begin(g);
    if (held_[g]) correction_.segment(3 * begin, 3 * (pattern_.border_end(g) - begin)).setZero();
  }
  secants_.apply(correction_, [this](Eigen::VectorXf& b) {
    warp_.turn_back(b);
    factor_.panels.solve(b.data(), held_);
    warp_.turn(b);
  });
  double slope = 0;
  for (int k = 0; k < unknowns; ++k) {
    slope += forces_.col(k).head<3>().dot(correction_.segment<3>(3 * k).cast<double>());
  }
  return slope;
}

/// Potential in J of x_begin_, as last evaluated, were the nodes to stay there through this step.
/// No minimum lies above it, and a step that ends above it has made energy out of nothing.
double CorotationalModel::potential_of_staying() const noexcept {
  return elastic_begin_ - external_.cwiseProduct(x_begin_ - rest_).sum() +
         inertia_->energy(v_, 1 / (step_.inertia * dt_ * dt_));
}

/// Corrections from where the velocities lead can be too few where a stiff body is struck hard.
/// Then they start from where the nodes are, which can only lose energy.
void CorotationalModel::stay_if_better(StepReport& report, double& energy, double dt,
                                       double start) noexcept {
  x_kept_ = x_;
  predict(dt, false);
  const double stay = evaluate();
  if (!std::isfinite(stay) || stay >= energy) {
    x_ = x_kept_;
    energy = evaluate();
    return;
  }
  energy = stay;
  secants_.clear();
  wanted_ = true;
  const int spent = report.iterations;
  report.iterations = 0;
  correct(report, energy, start);
  report.iterations += spent;
}

void CorotationalModel::correct(StepReport& report, double& energy, double start) noexcept {
  report.residual = residual();
  const int unknowns = pattern_.size();
  while (report.residual > options_.tolerance && report.iterations < options_.iterations &&
         !out_of_time(start)) {
    const double slope = find_correction();
    x_trial_ = x_;
    forces_trial_ = forces_;
    ++report.iterations;

    bool accepted = false;
    double alpha = 1, next = energy, next_residual = report.residual;
    for (int halving = 0; halving <= options_.halvings && !accepted; ++halving, alpha *= 0.5) {
      for (int k = 0; k < unknowns; ++k) {
        x_.col(k).head<3>() =
            x_trial_.col(k).head<3>() + alpha * correction_.segment<3>(3 * k).cast<double>();
      }
      next = evaluate();
      next_residual = residual();
      // Near the minimum the energy's own rounding hides its fall: there the residual decides.
      const double rounding = rounding_ * (std::abs(energy) + std::abs(next));
      accepted = next <= energy + 1e-4 * alpha * slope ||
                 (std::abs(next - energy) <= rounding && next_residual < report.residual);
    }
    if (!accepted) {
      x_ = x_trial_;
      evaluate();
      secants_.clear();
      wanted_ = true;
      break;
    }
    const double contraction = next_residual / report.residual;
    if (next_residual > options_.tolerance && contraction > options_.contraction) wanted_ = true;
    // Far from equilibrium, where the tangent is indefinite, secants mislead.
    if (factor_.exact) learn();
    energy = next;
    report.residual = next_residual;
    if (contraction * static_cast<double>(correction_.lpNorm<Eigen::Infinity>()) <
        options_.accuracy) {
      break;
    }
  }
  report.status =
      report.residual <= options_.tolerance ? StepStatus::kConverged : StepStatus::kNotConverged;
}

void CorotationalModel::learn() noexcept {
  for (int k = 0; k < pattern_.size(); ++k) {
    step_taken_.segment<3>(3 * k) = (x_.col(k) - x_trial_.col(k)).head<3>().cast<float>();
    force_change_.segment<3>(3 * k) =
        (forces_.col(k) - forces_trial_.col(k)).head<3>().cast<float>();
  }
  for (int g = 0; g < 2; ++g) {
    const int begin = pattern_.border_begin(g);
    if (!held_[g]) continue;
    force_change_.segment(3 * begin, 3 * (pattern_.border_end(g) - begin)).setZero();
  }
  secants_.add(step_taken_, force_change_);
}

void CorotationalModel::follow_rotations() noexcept {
  element_forces_->node_rotations(rotations_);
  warp_.update(rotations_, factor_.rotations);
  if (warp_.largest() > options_.turned) wanted_ = true;
}

/// Counts entanglement; true where it has put the nodes to a new start.
bool CorotationalModel::untangle() noexcept {
  const int inverted = element_forces_->inverted(x_);
  if (inverted == 0) {
    tangled_ = 0;
    untangled_ = false;
    return false;
  }
  ++tangled_;
  const bool hopeless = inverted * kHopelessShare > elements_.element_count();
  if (untangled_ || (tangled_ < kPatience && !hopeless)) return false;
  std::array<math::Pose, 2> motions{math::Pose::Identity(), math::Pose::Identity()};
  for (std::size_t g = 0; g < body_.grasps.size(); ++g) {
    if (held_[g]) motions[g] = grasps_[g].applied * body_.grasps[g].X_OG_rest.inverse();
  }
  for (int node = 0; node < positions_.cols(); ++node) {
    x_.col(numbering_[node]).head<3>() = blend_.position(node, held_, motions);
  }
  x_begin_ = x_inertial_ = x_;
  v_.setZero();
  element_forces_->reset();
  secants_.clear();
  tangled_ = 0;
  untangled_ = wanted_ = true;
  return true;
}

void CorotationalModel::turn_sensitivity(int begin, int end) noexcept {
  if (!at_snapshot_.valid) return;
  Turned turned{warp_, numbering_};
  for (int g = 0; g < 2; ++g) {
    turned.is_held[g] = held_[g];
    turned.grasps[g] = grasps_[g].applied.linear() * grasps_[g].snapshot.linear().transpose();
  }
  for (int c = 0; c < kContactSlots; ++c) {
    // The node that bears most of a contact says how its place has turned.
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
  for (int g = 0; g < 2; ++g) grasps_[g].snapshot = job_grasps_[g];
  sensitivity_.valid = at_snapshot_.valid;
  sensitivity_.age = job_age_;
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
  // Strains and rotations of the new shape, from which the next step starts.
  forces_.setZero();
  elastic_ = element_forces_->add(x_, 0, forces_);
  secants_.clear();
  wanted_ = true;
  ticks_ = kTanglePeriod - 1;  // the next step looks whether the shape is a possible one
  follow_rotations();
  return true;
}

}  // namespace palpate::elasticity
