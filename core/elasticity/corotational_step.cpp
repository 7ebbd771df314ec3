#include <algorithm>
#include <cmath>

#include "core/elasticity/corotational_model.hpp"

// One step of the co-rotational model: prediction, evaluation, correction, and recovery.
namespace palpate::elasticity {
namespace {

using Eigen::Vector3d;

// Steps between checks of the node rotations, which change by a few hundredths of a radian in
// between; the sensitivity is rotated piecewise in these steps.
constexpr int kLookPeriod = 4;
// Consecutive checks with a suspect shape before an alternative is tried; a single check with a
// tenth of the body inverted suffices.
constexpr int kPatience = 12;
constexpr int kHopelessShare = 10;
// Below this strain the shape is certainly valid. A shape is at rest if its energy changes by less
// than this fraction between two checks, and another one is better if its energy is lower by more.
constexpr double kSmallStrain = 0.1, kStill = 1e-3;
// Steps between measurements of the contraction of corrections.
constexpr int kMeasurePeriod = 10;

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
  // a factor for a very different step would contract slowly
  if (dynamic_ && std::abs(step_.inertia / factor_.step.inertia - 1) > 0.3) wanted_ = true;
  for (int node = 0; node < loads_.cols(); ++node) {
    external_.col(numbering_[node]).head<3>() = loads_.col(node);
  }
  external_.topRows<3>() += gravity_.asDiagonal() * weight_per_gravity_.topRows<3>();
  x_begin_ = x_;
  if (step_.viscous > 0) element_forces_->begin_step();
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
    if (ticks_ % kTanglePeriod == 0 && recover_inverted_elements(report)) energy = evaluate();
    const double initial = residual();
    correct(report, energy, start);
    if (dynamic_ && report.status != StepStatus::kConverged && report.residual > 0.05 * initial &&
        energy > potential_of_staying()) {
      stay_if_better(report, energy, dt, start);
    }
    detect_inversion(report);
    if (inverted_ && report.status == StepStatus::kConverged) {
      report.status = StepStatus::kNotConverged;
    }
  } else {
    x_ = x_begin_;
    grasps_ = grasps_begin;
    evaluate();
    if (!forces_.allFinite()) forces_.setZero();
    wanted_ = true;
  }
  if (report.status != StepStatus::kFailed) {
    if (dynamic_) v_ = (x_ - x_begin_) / dt;
    remember_surprise();
  }
  publish();
  sensitivity_.age += dt;
  factor_age_ += dt;
  job_age_ += dt;
  const auto n = static_cast<int>(positions_.cols());
  const int part = ticks_ % kLookPeriod;
  turn_sensitivity(n * part / kLookPeriod, n * (part + 1) / kLookPeriod);
  for (int column = 0; column < options_.refine && !out_of_time(start); ++column) {
    if (report.status != StepStatus::kFailed) refine_column();
  }
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
  x_expected_ = x_;
  if (follow) x_ += persistence_ * prediction_error_;
  for (int g = 0; g < grasps; ++g) {
    if (!held_[g]) continue;
    grasps_[g].applied = grasps_[g].target;
    const math::Pose moved = grasps_[g].target * body_.grasps[g].X_OG_rest.inverse();
    for (int node : body_.grasps[g].nodes) {
      x_.col(numbering_[node]).head<3>() = moved * body_.mesh.nodes.col(node);
    }
  }
}

/// Potential at x_, J; its derivative, the unbalanced forces, goes to forces_.
double CorotationalModel::evaluate() noexcept {
  forces_ = -external_;
  double energy = -external_.cwiseProduct(x_ - rest_).sum();
  elastic_ = element_forces_->add(x_, step_.viscous, forces_);
  energy += elastic_;
  if (dynamic_) energy += inertia_->add(x_, x_inertial_, step_.inertia, forces_);
  return energy;
}

/// Largest unbalanced force at a free node, N.
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

/// Computes correction_; returns the slope of the potential along it, J.
double CorotationalModel::find_correction() noexcept {
  for (int k = 0; k < pattern_.size(); ++k) {
    correction_.segment<3>(3 * k) = -forces_.col(k).head<3>().cast<float>();
  }
  solve_for(correction_);
  return slope();
}

/// Overwrites b (the axes of an unknown node adjacent) with the approximate solution for the
/// present tangent: the old factor, rotated and improved. Held nodes get zero.
void CorotationalModel::solve_for(Eigen::VectorXf& b) noexcept {
  for (int g = 0; g < 2; ++g) {
    const int begin = pattern_.border_begin(g);
    if (held_[g]) b.segment(3 * begin, 3 * (pattern_.border_end(g) - begin)).setZero();
  }
  secants_.apply(b, [this](Eigen::VectorXf& v) {
    warp_.turn_back(v);
    factor_.panels.solve(v.data(), held_);
    warp_.turn(v);
  });
}

/// Slope of the potential along correction_ at x_, J.
double CorotationalModel::slope() const noexcept {
  double sum = 0;
  for (int k = 0; k < pattern_.size(); ++k) {
    sum += forces_.col(k).head<3>().dot(correction_.segment<3>(3 * k).cast<double>());
  }
  return sum;
}

void CorotationalModel::add_correction(const NodalField& from, double share) noexcept {
  for (int k = 0; k < pattern_.size(); ++k) {
    x_.col(k).head<3>() =
        from.col(k).head<3>() + share * correction_.segment<3>(3 * k).cast<double>();
  }
}

/// Potential, J, of x_begin_, as last evaluated, if the nodes remained there during this step. An
/// upper bound of the minimum: a step that ends above it has gained energy.
double CorotationalModel::potential_of_staying() const noexcept {
  return elastic_begin_ - external_.cwiseProduct(x_begin_ - rest_).sum() +
         inertia_->energy(v_, 1 / (step_.inertia * dt_ * dt_));
}

/// Prediction error of velocities or sensitivity (changes of velocity, or effects of changing
/// loads), and its persistence: the factor by which the last error would have predicted this one
/// best.
void CorotationalModel::remember_surprise() noexcept {
  double alike = 0, before = 0;
  for (int k = 0; k < pattern_.size(); ++k) {
    const Vector3d surprise = (x_.col(k) - x_expected_.col(k)).head<3>();
    auto last = prediction_error_.col(k).head<3>();
    if (k < pattern_.interior_size()) {
      alike += surprise.dot(last);
      before += last.squaredNorm();
    }
    last = surprise;
  }
  persistence_ = before > 0 ? std::clamp(alike / before, 0.0, 1.0) : 0;
}

/// When a stiff body is struck hard, corrections that start from the positions predicted by the
/// velocities can be too few. They then restart from the present positions, which can only lose
/// energy.
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
  bool settled = report.residual <= options_.tolerance;
  double last_size = 0;
  while (!settled && report.iterations < options_.iterations && !out_of_time(start)) {
    const double slope_begin = find_correction();
    const auto size = static_cast<double>(correction_.lpNorm<Eigen::Infinity>());
    if (last_size > 0) contraction_ = size / last_size;
    ++report.iterations;
    const bool is_last = is_last_correction(size, report.iterations);
    if (is_last && !options_.confirm && step_.viscous == 0 && factor_.exact && slope_begin < 0) {
      add_correction(x_, 1);
      report.residual *= contraction_;
      settled = true;
      break;
    }
    x_trial_ = x_;
    forces_trial_ = forces_;

    // A nearly singular tangent requests very large corrections repeatedly: after a failure their
    // length is limited.
    const double longest = std::min(1.0, reach_ / size);
    bool accepted = false;
    double share = longest, next = energy, next_residual = report.residual;
    for (int halving = 0; halving <= options_.halvings; ++halving, share *= 0.5) {
      add_correction(x_trial_, share);
      next = evaluate();
      next_residual = residual();
      // Near the minimum rounding errors exceed the decrease of the energy, which is then computed
      // from slopes: along a parabola it is their mean (approximate Wolfe condition, Hager and
      // Zhang 2005).
      const double rounding = rounding_ * (std::abs(energy) + std::abs(next));
      accepted = next <= energy + 1e-4 * share * slope_begin ||
                 (std::abs(next - energy) <= rounding && slope() < -0.9 * slope_begin);
      if (accepted) break;
    }
    if (!accepted) {
      reach_ = share * size;
      x_ = x_trial_;
      evaluate();
      secants_.clear();
      wanted_ = true;
      break;
    }
    reach_ = longest < 1 ? 4 * share * size : kFar;
    if (next_residual > options_.tolerance &&
        next_residual > options_.contraction * report.residual) {
      wanted_ = true;
    }
    // far from equilibrium, where the tangent is indefinite, secant pairs mislead
    if (factor_.exact) learn();
    energy = next;
    report.residual = next_residual;
    last_size = share == 1 ? size : 0;
    settled = is_last || next_residual <= options_.tolerance;
  }
  report.status = settled ? StepStatus::kConverged : StepStatus::kNotConverged;
}

/// Whether the next correction is expected to be below the accuracy after one that moves no node by
/// more than `size` m. The contraction is measured in some steps, which make two corrections for
/// that purpose, because the remaining forces say little about remaining errors in soft motions.
bool CorotationalModel::is_last_correction(double size, int iteration) const noexcept {
  const bool measures = ticks_ % kMeasurePeriod == 0 && iteration == 1;
  return !measures && contraction_ < 1 && contraction_ * size < options_.accuracy;
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

/// Checks the validity of the shape; after repeated suspicion restarts from a better one. True if
/// x_ must be evaluated again.
bool CorotationalModel::recover_inverted_elements(StepReport& report) noexcept {
  const ElementDoubts found = element_forces_->doubts(x_, kSmallStrain);
  const bool still = std::abs(elastic_ - elastic_at_look_) <= kStill * elastic_;
  elastic_at_look_ = elastic_;
  inverted_ = found.inverted > 0;
  torn_ = inverted_ || (torn_ && found.strained > 0);
  suspect_count_ = inverted_ || (torn_ && still) ? suspect_count_ + 1 : 0;
  const bool hopeless = found.inverted * kHopelessShare > elements_.element_count();
  if (suspect_count_ < kPatience && !hopeless) return false;
  suspect_count_ = 0;
  const double present = static_potential();
  std::array<math::Pose, 2> motions{math::Pose::Identity(), math::Pose::Identity()};
  for (std::size_t g = 0; g < body_.grasps.size(); ++g) {
    if (held_[g]) motions[g] = grasps_[g].applied * body_.grasps[g].X_OG_rest.inverse();
  }
  x_kept_ = x_;
  for (int node = 0; node < positions_.cols(); ++node) {
    x_.col(numbering_[node]).head<3>() = blend_.position(node, held_, motions);
  }
  if (!(static_potential() < present - kStill * elastic_)) {
    x_ = x_kept_;
    return true;
  }
  x_begin_ = x_inertial_ = x_;
  v_.setZero();
  prediction_error_.setZero();
  element_forces_->reset();
  secants_.clear();
  inverted_ = false;
  report.restarted = wanted_ = true;
  return true;
}

/// Between checks elements become inverted only if steps do not converge.
void CorotationalModel::detect_inversion(const StepReport& report) noexcept {
  if (torn_ || report.status == StepStatus::kConverged) return;
  torn_ = element_forces_->doubts(x_, kSmallStrain).inverted > 0;
}

/// Static potential of x_, J.
double CorotationalModel::static_potential() noexcept {
  forces_trial_.setZero();
  return element_forces_->add(x_, 0, forces_trial_) - external_.cwiseProduct(x_ - rest_).sum();
}

}  // namespace palpate::elasticity
