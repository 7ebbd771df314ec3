#include "core/control/quadratic_program.hpp"

#include <algorithm>
#include <cmath>

#include "core/control/control_law.hpp"
#include "core/math/option_check.hpp"

namespace palpate::control {
namespace {

const char* relaxed_limit_message(Limit limit) {
  switch (limit) {
    case Limit::kWrench:
      return "a limit of the grasp is relaxed";
    case Limit::kStress:
      return "the limit of stress is relaxed";
    case Limit::kStretch:
      return "the limit of stretch is relaxed";
    case Limit::kObstacle:
      return "an obstacle's clearance is relaxed";
    case Limit::kContactForce:
      return "the limit of the force on an obstacle is relaxed";
    case Limit::kWorkspace:
      return "the hand's workspace is relaxed";
    default:
      return "joints keep the hand from its speed and acceleration";
  }
}

const char* active_limit_message(Limit limit) {
  switch (limit) {
    case Limit::kWrench:
      return "the target lies beyond a limit of the grasp";
    case Limit::kStress:
      return "the target lies beyond the limit of stress";
    case Limit::kStretch:
      return "the target lies beyond the limit of stretch";
    case Limit::kObstacle:
      return "the target lies behind an obstacle";
    case Limit::kContactForce:
      return "the target lies beyond the limit of the force on an obstacle";
    case Limit::kJoint:
      return "the target lies beyond a joint's limit";
    default:
      return "the target lies beyond the hand's workspace";
  }
}

}  // namespace

QuadraticProgramLaw::QuadraticProgramLaw(const Options& options, const Limited& limited)
    : ProportionalTwist(options),
      limited_(limited),
      limits_(limited.limits, limited.grasps, limited.body),
      program_(limits_.variables()),
      reach_(limits_.variables()) {
  math::check_not_negative(limited.smoothness, "smoothness");
  math::check_option(static_cast<int>(limited.grasps.size()) == options.inverse.grasps, "grasps",
                     limited.grasps.size(),
                     std::to_string(options.inverse.grasps) + ", as the control law moves");
  before_ = PseudoInverse::Motion::Zero(6 * options.inverse.grasps);
  variables_ = MotionLimits::Variables::Zero(limits_.variables());
  map_.setZero(before_.size(), variables_.size());
  if (commands_joints()) return;
  for (int i = 0; i < map_.rows(); ++i) map_(i, i) = i % 6 < 3 ? 1 : 1 / options.inverse.length;
}

void QuadraticProgramLaw::configure_for(const shape::Feature& feature) {
  ProportionalTwist::configure_for(feature);
  J_.setZero(feature.dimension(), variables_.size());
  motion_.setZero(feature.dimension());
  reset();
}

void QuadraticProgramLaw::reset() noexcept {
  ProportionalTwist::reset();
  limits_.reset();
  solver_.reset();
  reach_solver_.reset();
  rest();
}

void QuadraticProgramLaw::rest() noexcept {
  before_.setZero();
  variables_.setZero();
}

/// False if the joint states are not available.
bool QuadraticProgramLaw::set_map(const LawInputs& inputs) noexcept {
  if (!commands_joints()) return true;
  if (inputs.joints == nullptr || inputs.joints->q.size() != variables_.size() ||
      inputs.joints->V_O_G_by_joints.cols() != variables_.size())
    return false;
  map_ = inputs.joints->V_O_G_by_joints;
  before_ = map_.lazyProduct(variables_);
  return true;
}

void QuadraticProgramLaw::set_objective(const Eigen::VectorXd& motion) noexcept {
  motion_ = motion.cwiseProduct(inverse().row_scale());
  program_.H.noalias() = J_.transpose().lazyProduct(J_);
  program_.g.noalias() = -J_.transpose().lazyProduct(motion_);
  const double mean = program_.H.trace() / program_.variables();
  const double damping = options().inverse.damping * options().inverse.damping * mean;
  program_.H.diagonal().array() += damping;
  reach_.H = program_.H;
  reach_.g = program_.g / options().gain;
  program_.H.diagonal().array() += limited_.smoothness * mean;
  program_.g -= limited_.smoothness * mean * variables_;
}

PseudoInverse::Motion QuadraticProgramLaw::solve(const LawInputs& inputs,
                                                 const Eigen::VectorXd& motion,
                                                 LawOutput& output) noexcept {
  using Solver = math::QuadraticProgramSolver;
  if (!set_map(inputs)) {
    rest();
    output.remark = "the joints are not known";
    return before_;
  }
  J_ = inverse().row_scale().asDiagonal() * inputs.jacobian->lazyProduct(map_);
  set_objective(motion);
  limits_.look(inputs);
  program_.clear_rows();
  limits_.add_rates(program_, inputs, map_, before_, variables_);
  limits_.add_places(program_, inputs, map_, variables_);

  if (solver_.solve(program_) != Solver::Status::kOptimal) {
    solver_.reset();
    rest();
    output.remark = "no motion keeps the limits";
    return before_;
  }
  variables_ = solver_.u();
  before_ = map_.lazyProduct(variables_);
  double factor = 1;
  for (int g = 0; g < options().inverse.grasps; ++g)
    factor = std::min(factor, speed_factor(math::Twist::from(before_.segment<6>(6 * g)),
                                           options().linear_speed, options().angular_speed));
  before_ *= factor;
  variables_ *= factor;
  if (commands_joints()) output.joint_velocity = variables_;
  output.remark = remark(inputs);
  add_unreachable(inputs, output);
  return before_;
}

/// Message about the relaxed row with the highest priority.
const char* QuadraticProgramLaw::remark(const LawInputs& inputs) noexcept {
  int worst = -1;
  const auto rank = [&](int row) {
    const math::RowPriority& priority = program_.bounds[row].priority;
    return priority.level - 1e-3 * priority.weight;
  };
  for (int row = 0; row < program_.rows(); ++row) {
    if (program_.bounds[row].priority.level == 0 || solver_.violations()[row] == 0) continue;
    if (worst < 0 || rank(row) < rank(worst)) worst = row;
  }
  if (worst >= 0) return relaxed_limit_message(limits_.limit_of(worst));
  if (inputs.model != nullptr && limits_.buckling_scale(*inputs.model) < 1)
    return "slows down near buckling";
  return "";
}

/// Error that remains after the best displacement within all limits: the same program without rate
/// limits and with distances instead of approach speeds.
void QuadraticProgramLaw::add_unreachable(const LawInputs& inputs, LawOutput& output) noexcept {
  bool pressed = false;
  for (int row = 0; row < program_.rows(); ++row) {
    const Limit limit = limits_.limit_of(row);
    if (limit == Limit::kHandRate || limit == Limit::kJointRate) continue;
    pressed = pressed || solver_.multipliers()[row] != 0;
  }
  if (!pressed) return;
  reach_.clear_rows();
  limits_.add_gaps(reach_, inputs, map_);
  if (reach_solver_.solve(reach_) != math::QuadraticProgramSolver::Status::kOptimal) {
    reach_solver_.reset();
    return;
  }
  int hardest = -1;
  double most = 0;
  for (int row = 0; row < reach_.rows(); ++row) {
    const double press = std::abs(reach_solver_.multipliers()[row]) * reach_.A.col(row).norm();
    if (press <= most) continue;
    most = press;
    hardest = row;
  }
  if (hardest < 0) return;  // the displacement ends before any limit
  motion_ /= options().gain;
  motion_.noalias() -= J_.lazyProduct(reach_solver_.u());
  output.unreachable += motion_.cwiseQuotient(inverse().row_scale());
  if (*output.remark == '\0' && motion_.norm() > options().dead_band.position)
    output.remark = active_limit_message(limits_.limit_of(hardest));
}

}  // namespace palpate::control
