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

const Body& checked(const Body& body) {
  body.check();
  return body;
}

Eigen::SparseMatrix<double, Eigen::RowMajor> mass_matrix(const ElementSet& elements) {
  const mesh::ElementMesh& mesh = elements.mesh();
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixXd m;
  for (int e = 0; e < elements.element_count(); ++e) {
    elements.mass(e, m);
    for (int a = 0; a < m.rows(); ++a) {
      for (int b = 0; b < m.cols(); ++b) {
        entries.emplace_back(mesh.elements(a, e), mesh.elements(b, e), m(a, b));
      }
    }
  }
  Eigen::SparseMatrix<double, Eigen::RowMajor> mass(mesh.node_count(), mesh.node_count());
  mass.setFromTriplets(entries.begin(), entries.end());
  return mass;
}

}  // namespace

CorotationalModel::CorotationalModel(Body body, const SolverOptions& options, Mechanics mechanics)
    : body_(checked(body)),
      options_(options),
      dynamic_(mechanics == Mechanics::kDynamic),
      elements_(body_.mesh, body_.material),
      pattern_(body_.mesh.elements, body_.mesh.node_count(), body_.fixed_nodes),
      held_(pattern_.size(), 0),
      gravity_(body_.gravity_O),
      rhs_(Eigen::Matrix4Xd::Zero(4, pattern_.size())),
      step_taken_(rhs_),
      force_change_(rhs_),
      secants_(pattern_.size()),
      state_(elements_.make_state()),
      factor_(pattern_, elements_),
      job_(elements_, pattern_, body_.grasps) {
  if (options.iterations < 1 || options.halvings < 0 || !(options.tolerance > 0) ||
      !(options.time_step > 0) || !(options.turned > 0) || !(options.contraction > 0)) {
    throw std::invalid_argument("solver options: a value is out of range");
  }
  if (dynamic_) mass_ = mass_matrix(elements_);
  const Matrix3Xd zero = Matrix3Xd::Zero(3, body_.mesh.node_count());
  for (Matrix3Xd* m :
       {&loads_, &external_, &v_, &x_inertial_, &x_trial_, &dx_, &forces_, &forces_trial_}) {
    *m = zero;
  }
  x_ = x_begin_ = body_.mesh.nodes;
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
  x_ = body_.mesh.nodes;
  v_.setZero();
  loads_.setZero();
  forces_.setZero();
  for (Grasp& grasp : grasps_) grasp.held = false;
  std::fill(held_.begin(), held_.end(), 0);
  std::fill(state_.begin(), state_.end(), PointState());
  sensitivity_.valid = false;
  secants_.clear();
}

void CorotationalModel::hold(int grasp, const math::Pose& X_OG) noexcept {
  Grasp& g = grasps_[grasp];
  g.target = X_OG;
  if (g.held) return;
  const GraspRegion& region = body_.grasps[grasp];
  g.held = true;
  g.applied = grasp_pose(body_, grasp, x_);
  for (int node : region.nodes) held_[pattern_.unknown(node)] = 1;
  sensitivity_.valid = false;
}

void CorotationalModel::release(int grasp) noexcept {
  if (!grasps_[grasp].held) return;
  grasps_[grasp].held = false;
  for (int node : body_.grasps[grasp].nodes) held_[pattern_.unknown(node)] = 0;
  sensitivity_.valid = false;
}

bool CorotationalModel::inputs_are_finite() const noexcept {
  if (!loads_.allFinite() || !gravity_.allFinite()) return false;
  for (const Grasp& g : grasps_) {
    if (g.held && !g.target.matrix().allFinite()) return false;
  }
  return true;
}

StepReport CorotationalModel::step(double dt) noexcept {
  StepReport report;
  if (!(dt > 0) || !factor_.usable || factor_.held != held_ || !inputs_are_finite()) {
    report.residual = residual();
    return report;
  }
  const std::array<Grasp, 2> grasps_begin = grasps_;
  step_ = step_factors(dt);
  // A factor made for a quite different step would contract slowly.
  if (dynamic_ && std::abs(step_.inertia / factor_.step.inertia - 1) > 0.3) wanted_ = true;
  external_ = loads_;
  external_.noalias() += gravity_ * elements_.nodal_mass().transpose();
  x_begin_ = x_;
  ElementSet::begin_step(state_);

  predict(dt, true);
  double energy = evaluate();
  if (!std::isfinite(energy) || !forces_.allFinite()) {
    predict(dt, false);
    energy = evaluate();
  }
  if (std::isfinite(energy) && forces_.allFinite()) {
    correct(report, energy);
  } else {
    x_ = x_begin_;
    grasps_ = grasps_begin;
    evaluate();
    if (!forces_.allFinite()) forces_.setZero();
    wanted_ = true;
  }
  if (report.status != StepStatus::kFailed && dynamic_) v_ = (x_ - x_begin_) / dt;
  sensitivity_.age += dt;
  job_age_ += dt;
  observe_turn();
  return report;
}

void CorotationalModel::predict(double dt, bool follow) noexcept {
  x_ = x_begin_;
  if (dynamic_) {
    x_inertial_ = x_begin_ + v_ * (1 / (dt * step_.inertia));
    if (follow) x_ += dt * v_;
  }
  for (std::size_t g = 0; g < body_.grasps.size(); ++g) {
    Grasp& grasp = grasps_[g];
    if (!grasp.held) continue;
    if (follow && !dynamic_ && sensitivity_.valid && sensitivity_.dx_dxi[g].rows() == x_.size()) {
      math::Vector6d motion;
      motion.head<3>() = grasp.target.translation() - grasp.applied.translation();
      motion.tail<3>() =
          math::log_rotation(grasp.target.linear() * grasp.applied.linear().transpose());
      if (!motion.isZero(0)) {
        Eigen::Map<Eigen::VectorXd>(x_.data(), x_.size()).noalias() +=
            sensitivity_.dx_dxi[g].lazyProduct(motion);
      }
    }
  }
  for (std::size_t g = 0; g < body_.grasps.size(); ++g) {
    Grasp& grasp = grasps_[g];
    if (!grasp.held) continue;
    grasp.applied = grasp.target;
    const math::Pose moved = grasp.target * body_.grasps[g].X_OG_rest.inverse();
    for (int node : body_.grasps[g].nodes) x_.col(node) = moved * body_.mesh.nodes.col(node);
  }
}

/// Potential at x_ in J; leaves its derivative, the forces out of balance, in forces_.
double CorotationalModel::evaluate() noexcept {
  forces_ = -external_;
  double energy = -(external_.array() * (x_ - body_.mesh.nodes).array()).sum();
  energy += elements_.add_forces(x_, step_.viscous, state_, forces_);
  if (dynamic_) {
    for (int i = 0; i < mass_.rows(); ++i) {
      Vector3d inertia = Vector3d::Zero();
      for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(mass_, i); it; ++it) {
        inertia += it.value() * (x_.col(it.col()) - x_inertial_.col(it.col()));
      }
      inertia *= step_.inertia;
      forces_.col(i) += inertia;
      energy += 0.5 * inertia.dot(x_.col(i) - x_inertial_.col(i));
    }
  }
  return energy;
}

double CorotationalModel::residual() const noexcept {
  double largest = 0;
  for (int k = 0; k < pattern_.size(); ++k) {
    if (!held_[k]) largest = std::max(largest, forces_.col(pattern_.node(k)).squaredNorm());
  }
  return std::sqrt(largest);
}

void CorotationalModel::correct(StepReport& report, double energy) noexcept {
  report.residual = residual();
  while (report.residual > options_.tolerance && report.iterations < options_.iterations) {
    for (int k = 0; k < pattern_.size(); ++k) {
      rhs_.col(k).setZero();
      if (!held_[k]) rhs_.col(k).head<3>() = -forces_.col(pattern_.node(k));
    }
    secants_.apply(rhs_, [this](Eigen::Matrix4Xd& b) { factor_.ldl.solve(b); });
    double slope = 0;
    for (int k = 0; k < pattern_.size(); ++k) {
      const int node = pattern_.node(k);
      dx_.col(node) = rhs_.col(k).head<3>();
      if (!held_[k]) slope += forces_.col(node).dot(dx_.col(node));
    }
    x_trial_ = x_;
    forces_trial_ = forces_;
    ++report.iterations;

    bool accepted = false;
    double alpha = 1, next = energy, next_residual = report.residual;
    for (int halving = 0; halving <= options_.halvings && !accepted; ++halving, alpha *= 0.5) {
      x_ = x_trial_ + alpha * dx_;
      next = evaluate();
      next_residual = residual();
      // Near the minimum the energy's own rounding hides its fall: there the residual decides.
      const double rounding = 1e-12 * (std::abs(energy) + std::abs(next));
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
    if (next_residual > options_.tolerance &&
        next_residual > options_.contraction * report.residual) {
      wanted_ = true;
    }
    // Far from equilibrium, where the tangent is indefinite, secants mislead.
    if (factor_.exact) learn();
    energy = next;
    report.residual = next_residual;
  }
  report.status =
      report.residual <= options_.tolerance ? StepStatus::kConverged : StepStatus::kNotConverged;
}

void CorotationalModel::learn() noexcept {
  for (int k = 0; k < pattern_.size(); ++k) {
    if (held_[k]) {
      step_taken_.col(k).setZero();
      force_change_.col(k).setZero();
      continue;
    }
    const int node = pattern_.node(k);
    step_taken_.col(k).head<3>() = x_.col(node) - x_trial_.col(node);
    force_change_.col(k).head<3>() = forces_.col(node) - forces_trial_.col(node);
  }
  secants_.add(step_taken_, force_change_);
}

void CorotationalModel::observe_turn() noexcept {
  const double limit = std::cos(options_.turned / 2);
  for (std::size_t b = 0; b < state_.size() && !wanted_; ++b) {
    const auto& q = state_[b].rotation;
    const auto& p = factor_.state[b].rotation;
    const Lanes cosine = q[0] * p[0] + q[1] * p[1] + q[2] * p[2] + q[3] * p[3];
    if ((cosine.abs() < limit).any()) wanted_ = true;
  }
}

math::Wrench CorotationalModel::reaction(int grasp) const noexcept {
  math::Wrench wrench;
  if (!grasps_[grasp].held) return wrench;
  const Vector3d origin = grasps_[grasp].applied.translation();
  for (int node : body_.grasps[grasp].nodes) {
    wrench.force += forces_.col(node);
    wrench.torque += (x_.col(node) - origin).cross(forces_.col(node));
  }
  return wrench;
}

Refactorisation* CorotationalModel::wanted_refactorisation() noexcept {
  if (outstanding_ || (!wanted_ && factor_.usable && factor_.held == held_)) return nullptr;
  job_.positions = x_;
  job_.external = loads_;
  job_.external.noalias() += gravity_ * elements_.nodal_mass().transpose();
  for (std::size_t g = 0; g < body_.grasps.size(); ++g) {
    job_.is_held[g] = grasps_[g].held;
    job_.origins[g] = grasps_[g].applied.translation();
  }
  job_.factor.held = held_;
  job_.factor.state = state_;
  job_.factor.step = step_;
  job_age_ = 0;
  outstanding_ = true;
  wanted_ = false;
  return &job_;
}

void CorotationalModel::install(Refactorisation& done) noexcept {
  if (&done != &job_ || !outstanding_) return;
  outstanding_ = false;
  if (!job_.factor.usable || job_.factor.held != held_) {
    wanted_ = true;
    return;
  }
  std::swap(factor_, job_.factor);
  secants_.clear();
  std::swap(sensitivity_, job_.sensitivity);
  sensitivity_.age = job_age_;
}

bool CorotationalModel::restore(const Matrix3Xd& positions, const Matrix3Xd& velocities) noexcept {
  if (positions.cols() != x_.cols() || velocities.cols() != x_.cols() || !positions.allFinite() ||
      !velocities.allFinite()) {
    return false;
  }
  x_ = positions;
  v_ = velocities;
  if (!dynamic_) v_.setZero();
  for (int node : body_.fixed_nodes) {
    x_.col(node) = body_.mesh.nodes.col(node);
    v_.col(node).setZero();
  }
  for (std::size_t g = 0; g < body_.grasps.size(); ++g) {
    if (grasps_[g].held) grasps_[g].applied = grasp_pose(body_, static_cast<int>(g), x_);
  }
  // Stretches and rotations of the new shape, from which the next step starts.
  forces_.setZero();
  elements_.add_forces(x_, 0, state_, forces_);
  secants_.clear();
  wanted_ = true;
  return true;
}

}  // namespace palpate::elasticity
