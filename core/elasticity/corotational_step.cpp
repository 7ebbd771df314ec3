#include <algorithm>
#include <cmath>

#include "core/elasticity/corotational_model.hpp"

// One step of the co-rotational model: predict, evaluate, correct, and what to do when that is not
// enough.
namespace palpate::elasticity {
namespace {

using Eigen::Vector3d;

// Rotations of nodes are looked at once in so many steps, in which they change by some hundredths
// of a radian; the sensitivity is turned with them piece by piece in between.
constexpr int kLookPeriod = 4;
// So many looks for inside-out elements in a row that find some, or one that finds a tenth of the
// body like that, and the shape is given up.
constexpr int kPatience = 12;
constexpr int kHopelessShare = 10;

}  // namespace

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
  team().call_up();
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

}  // namespace palpate::elasticity
