#include "core/control/quadratic_program.hpp"

#include <stdexcept>

#include "core/control/speed_limit.hpp"

namespace palpate::control {

QuadraticProgramLaw::QuadraticProgramLaw(const Options& options, const Limited& limited)
    : ProportionalTwist(options),
      smoothness_(limited.smoothness),
      limits_(limited.limits, limited.grasps),
      program_(6 * options.inverse.grasps) {
  if (!(limited.smoothness >= 0))
    throw std::invalid_argument("smoothness of the control law must not be negative");
  if (static_cast<int>(limited.grasps.size()) != options.inverse.grasps)
    throw std::invalid_argument("limits speak of other grasps than the control law");
  scale_ = PseudoInverse::Motion::Ones(program_.variables());
  for (int i = 0; i < scale_.size(); ++i)
    if (i % 6 >= 3) scale_[i] = 1 / options.inverse.length;
  before_ = PseudoInverse::Motion::Zero(program_.variables());
}

void QuadraticProgramLaw::configure_for(const shape::Feature& feature) {
  ProportionalTwist::configure_for(feature);
  J_.setZero(feature.dimension(), program_.variables());
  motion_.setZero(feature.dimension());
  reset();
}

void QuadraticProgramLaw::reset() noexcept {
  ProportionalTwist::reset();
  limits_.reset();
  solver_.reset();
  before_.setZero();
}

PseudoInverse::Motion QuadraticProgramLaw::solve(const LawInputs& inputs,
                                                 const Eigen::VectorXd& motion,
                                                 LawOutput& output) noexcept {
  using Solver = math::QuadraticProgramSolver;
  const Eigen::VectorXd& rows = inverse().row_scale();
  for (int column = 0; column < J_.cols(); ++column)
    J_.col(column) = inputs.jacobian->col(column).cwiseProduct(rows) * scale_[column];
  motion_ = motion.cwiseProduct(rows);

  program_.clear_rows();
  program_.H.noalias() = J_.transpose() * J_;
  program_.g.noalias() = -J_.transpose() * motion_;
  const double mean = program_.H.trace() / program_.variables();
  const double damping = options().inverse.damping * options().inverse.damping * mean;
  program_.H.diagonal().array() += damping + smoothness_ * mean;
  program_.g -= smoothness_ * mean * before_.cwiseQuotient(scale_);
  limits_.add_to(program_, inputs, before_, scale_);

  const Solver::Status status = solver_.solve(program_);
  if (status == Solver::Status::kOptimal) {
    before_ = solver_.u().cwiseProduct(scale_);
    for (int g = 0; g < options().inverse.grasps; ++g)
      before_ *= speed_factor(math::Twist::from(before_.segment<6>(6 * g)), options().linear_speed,
                              options().angular_speed);
    if (solver_.worst_violation(program_, 1) > 0) {
      output.remark = "a limit of the grasp gives way";
    } else if (solver_.worst_violation(program_, 2) > 0) {
      output.remark = "an obstacle's clearance gives way";
    } else if (solver_.worst_violation(program_, 3) > 0) {
      output.remark = "the hand's workspace gives way";
    } else if (inputs.model != nullptr && limits_.ease(*inputs.model) < 1) {
      output.remark = "slows down near buckling";
    }
  } else {
    solver_.reset();
    before_.setZero();
    output.remark = "no motion keeps the limits";
  }
  return before_;
}

}  // namespace palpate::control
