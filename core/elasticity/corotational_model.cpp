#include "core/elasticity/corotational_model.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/math/option_check.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::Matrix3Xd;

// Steps between checks of the node rotations, which change by a few hundredths of a radian in
// between; the sensitivity is rotated piecewise in these steps.
constexpr int kLookPeriod = 4;
constexpr int kTanglePeriod = 16;   // steps between checks for inverted elements
constexpr int kMeasurePeriod = 10;  // steps between measurements of the contraction of corrections
constexpr int kForesight = 40;      // steps until a requested factor is in use

/// Where points strike an obstacle whose compliances are not known yet they penetrate, and are then
/// pushed out: a dynamic body gains energy.
SolverOptions with_foresight(SolverOptions options, bool dynamic) {
  if (dynamic) options.contact.foresight = kForesight;
  return options;
}

}  // namespace

CorotationalModel::CorotationalModel(Body body, const SolverOptions& options, Mechanics mechanics)
    : options_(with_foresight(options, mechanics == Mechanics::kDynamic)),
      dynamic_(mechanics == Mechanics::kDynamic),
      body_(std::move(body), options_.orders),
      boundary_(body_),
      samples_(ObstacleContacts::numbered_samples(body_, options_.contact)),
      motion_(body_, dynamic_),
      potential_(body_, options_, dynamic_),
      factor_(body_, options_, samples_),
      contacts_(options_.contact.obstacles.empty()
                    ? nullptr
                    : std::make_unique<ObstacleContacts>(body_, boundary_, factor_,
                                                         options_.contact, samples_)),
      corrections_(body_, boundary_, potential_, factor_, contacts_.get(), options_),
      recovery_(body_, boundary_, potential_),
      sensitivity_(body_, boundary_, factor_.warp(),
                   static_cast<int>(collision::free_directions(options_.contact.obstacles).size())),
      x_corrected_(body_.rest),
      job_(body_, options_, samples_) {
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
    refinement_.emplace(body_, boundary_, factor_, sensitivity_, options.precision);
  }
}

void CorotationalModel::prepare() {
  reset();
  boundary_.set_gravity(body_.body.gravity_O);
  potential_.set_time_step(options_.time_step);
  outstanding_ = false;
  Refactorisation* job = wanted_refactorisation();
  job->run();
  install(*job);
}

void CorotationalModel::reset() noexcept {
  boundary_.clear();
  releasing_ = {false, false};
  motion_.reset();
  potential_.reset();
  factor_.reset();
  if (contacts_) contacts_->reset();
  corrections_.forget_failures();
  sensitivity_.invalidate();
  recovery_.forget();
}

void CorotationalModel::hold(int grasp, const math::Pose& X_OG) noexcept {
  releasing_[grasp] = false;
  if (boundary_.hold(grasp, X_OG, motion_.positions())) grasps_have_changed();
}

void CorotationalModel::release(int grasp) noexcept {
  if (!is_held(grasp) || releasing_[grasp]) return;
  releasing_[grasp] = true;
  if (factor_.serves(held_after_releases())) return complete_releases();
  factor_.want_new();
}

factor::Held CorotationalModel::held_after_releases() const noexcept {
  factor::Held held = boundary_.held();
  for (int g = 0; g < 2; ++g) held[g] = held[g] && !releasing_[g];
  return held;
}

void CorotationalModel::complete_releases() noexcept {
  for (int g = 0; g < 2; ++g) {
    if (releasing_[g] && boundary_.release(g)) grasps_have_changed();
  }
  releasing_ = {false, false};
}

void CorotationalModel::grasps_have_changed() noexcept {
  sensitivity_.invalidate();
  factor_.secants().clear();
  factor_.columns().clear();
  if (contacts_) contacts_->forget_compliances();
  corrections_.forget_contraction();
  factor_.want_new();
}

math::Wrench CorotationalModel::reaction(int grasp) const noexcept {
  return boundary_.reaction(grasp, potential_.forces(), motion_.positions());
}

const std::vector<SurfaceContact>& CorotationalModel::contacts() const noexcept {
  return contacts_ ? contacts_->contacts() : kNoContacts;
}

void CorotationalModel::place_obstacle(int index, const collision::Placement& placement) noexcept {
  if (contacts_) contacts_->place(index, placement);
}

void CorotationalModel::watch_contact(int slot, const mesh::PointWeights& point) noexcept {
  sensitivity_.watch_contact(slot, point);
  factor_.want_new();
}

StepReport CorotationalModel::step(double dt) noexcept {
  StepReport report;
  team_of(options_).call_up();
  const StepBudget budget(options_);
  if (!(dt > 0) || !factor_.serves(boundary_.held()) || !boundary_.are_finite()) {
    report.residual = corrections_.residual();
    return report;
  }
  const std::array<math::Pose, 2> hands_begin = boundary_.applied();
  potential_.set_time_step(dt);
  // a factor for a very different step would contract slowly
  if (dynamic_ && std::abs(potential_.factors().inertia / factor_.step().inertia - 1) > 0.3) {
    factor_.want_new();
  }
  potential_.begin_step(boundary_);
  if (contacts_) contacts_->begin_step(motion_.x(), potential_);
  motion_.begin_step();

  double energy = evaluate_prediction(dt);
  if (std::isfinite(energy)) {
    if (++ticks_ % kLookPeriod == 0) factor_.follow(potential_.elements());
    if (ticks_ % kTanglePeriod == 0) recover_inverted_elements(report, energy);
    const double initial = corrections_.residual();
    corrections_.minimise(motion_.x(), energy, report, budget, ticks_ % kMeasurePeriod == 0);
    if (dynamic_ && report.status != StepStatus::kConverged && report.residual > 0.05 * initial &&
        energy > potential_.of_staying(motion_.x_begin(), motion_.v())) {
      stay_if_better(report, energy, dt, budget);
    }
    if (report.status != StepStatus::kConverged) recovery_.detect(motion_.x());
    if (recovery_.is_inverted() && report.status == StepStatus::kConverged) {
      report.status = StepStatus::kNotConverged;
    }
    if (contacts_) contacts_->finish_step(motion_.x());
    motion_.finish_step(dt);
  } else {
    motion_.undo_step();
    boundary_.set_applied(hands_begin);
    potential_.evaluate(motion_.x());
    if (!potential_.forces().allFinite()) potential_.clear_forces();
    factor_.want_new();
  }
  motion_.publish();
  sensitivity_.advance(dt);
  factor_.advance(dt);
  job_age_ += dt;
  sensitivity_.turn(ticks_ % kLookPeriod, kLookPeriod);
  for (int g = 0; g < 2; ++g)
    if (boundary_.held()[g]) sensitivity_.follow_wrench(g, reaction(g).vector());
  // the refinement knows forces on the free nodes that do not change, unlike those of contact
  const bool refines = !contacts_ || !contacts_->is_touching();
  for (int column = 0; refines && column < options_.refine && !budget.is_spent(); ++column) {
    if (refinement_ && report.status != StepStatus::kFailed) refinement_->refine_next(motion_.x());
  }
  return report;
}

void CorotationalModel::predict(double dt, bool follow) noexcept {
  NodalField& x = motion_.x();
  x = motion_.x_begin();
  if (dynamic_) {
    potential_.set_inertial_motion(motion_.x_begin(), motion_.v());
    if (follow) x += dt * motion_.v();
  } else if (follow) {
    sensitivity_.follow_hands(x);
  }
  motion_.complete_prediction(follow);
  boundary_.apply(x);
}

/// Where contacts alone keep the body from buckling, the sensitivity is that of a nearly singular
/// equilibrium, and what it predicts may lie beyond obstacles.
bool CorotationalModel::is_prediction_plausible() const noexcept {
  if (dynamic_ || !contacts_) return true;
  const factor::BlockPattern& pattern = body_.pattern;
  double largest = 0, hands = 0;  // m^2
  for (int k = 0; k < pattern.size(); ++k) {
    const double moved = (motion_.x().col(k) - motion_.x_begin().col(k)).squaredNorm();
    double& most = pattern.is_free(k, boundary_.held()) ? largest : hands;
    most = std::max(most, moved);
  }
  return std::sqrt(largest) <= contacts_->farthest() + 4 * std::sqrt(hands);
}

/// Potential, J, at the predicted positions, or at those of the last step, moved by the hands
/// alone, if the former is not finite or plausible; not finite if neither is.
double CorotationalModel::evaluate_prediction(double dt) noexcept {
  double energy = 0;
  for (const bool follow : {true, false}) {
    predict(dt, follow);
    if (follow && !is_prediction_plausible()) continue;
    energy = potential_.evaluate(motion_.x());
    if (std::isfinite(energy) && potential_.forces().allFinite()) return energy;
  }
  return std::nan("");
}

void CorotationalModel::recover_inverted_elements(StepReport& report, double& energy) noexcept {
  const InversionRecovery::Outcome outcome = recovery_.check(motion_.x());
  if (outcome == InversionRecovery::Outcome::kKept) return;
  if (outcome == InversionRecovery::Outcome::kReplaced) {
    motion_.stop();
    potential_.forget_history(motion_.x());
    factor_.secants().clear();
    factor_.want_new();
    report.restarted = true;
  }
  energy = potential_.evaluate(motion_.x());
}

/// When a stiff body is struck hard, corrections that start from the positions predicted by the
/// velocities can be too few. They then restart from the present positions, which can only lose
/// energy.
void CorotationalModel::stay_if_better(StepReport& report, double& energy, double dt,
                                       const StepBudget& budget) noexcept {
  NodalField& x = motion_.x();
  x_corrected_ = x;
  predict(dt, false);
  const double stay = potential_.evaluate(x);
  if (!std::isfinite(stay) || stay >= energy) {
    x = x_corrected_;
    energy = potential_.evaluate(x);
    return;
  }
  energy = stay;
  factor_.secants().clear();
  factor_.want_new();
  const int spent = report.iterations;
  report.iterations = 0;
  corrections_.minimise(x, energy, report, budget, ticks_ % kMeasurePeriod == 0);
  report.iterations += spent;
}

Refactorisation* CorotationalModel::wanted_refactorisation() noexcept {
  if (outstanding_ || (!factor_.is_new_wanted() && factor_.is_usable())) return nullptr;
  Snapshot& snapshot = job_.snapshot;
  snapshot.positions = motion_.positions();
  snapshot.loads = boundary_.loads();
  snapshot.gravity_O = boundary_.gravity();
  snapshot.held = held_after_releases();
  snapshot.contacts = sensitivity_.contacts();
  snapshot.grasps = boundary_.applied();
  if (contacts_) contacts_->describe(job_.contact_samples, snapshot);
  job_.factor.rotations = factor_.measure_rotations(potential_.elements());
  job_.factor.step = potential_.factors();
  job_age_ = 0;
  outstanding_ = true;
  factor_.clear_wanted();
  return &job_;
}

void CorotationalModel::install(Refactorisation& done) noexcept {
  if (&done != &job_ || !outstanding_) return;
  outstanding_ = false;
  if (job_.snapshot.held == held_after_releases()) complete_releases();
  if (!job_.factor.usable || !job_.factor.panels.usable(boundary_.held())) {
    factor_.want_new();
    return;
  }
  factor_.install(job_.factor, job_age_, potential_.elements());
  if (contacts_) contacts_->forget_compliances();
  if (job_.snapshot.held != boundary_.held()) {
    factor_.columns().clear();
    return;
  }
  sensitivity_.install(job_.sensitivity, job_.snapshot.grasps, job_age_);
  if (!dynamic_) motion_.forget_persistence();
}

bool CorotationalModel::restore(const Matrix3Xd& positions, const Matrix3Xd& velocities) noexcept {
  if (!motion_.restore(positions, velocities)) return false;
  boundary_.set_applied_by(motion_.positions());
  // strains and rotations of the new shape, from which the next step starts
  potential_.restart(motion_.x());
  factor_.secants().clear();
  factor_.want_new();
  recovery_.forget();
  ticks_ = kTanglePeriod - 1;  // the next step checks whether the shape is valid
  factor_.follow(potential_.elements());
  return true;
}

}  // namespace palpate::elasticity
