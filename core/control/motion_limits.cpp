#include "core/control/motion_limits.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace palpate::control {
namespace {

using math::QuadraticProgram;
constexpr math::RowPriority kGrasp{1, 1.0}, kObstacle{2, 1.0}, kWorkspace{3, 1.0};
constexpr int kFacets = 8;  // of the slip cone's pyramid, which lies within it

}  // namespace

MotionLimits::MotionLimits(const MotionLimitOptions& options, std::vector<int> grasps)
    : options_(options), grasps_(std::move(grasps)) {
  const auto positive = [](double value, const char* name) {
    if (!(value > 0 && std::isfinite(value)))
      throw std::invalid_argument(std::string(name) + " of a motion must be positive");
  };
  positive(options.linear_speed, "linear speed");
  positive(options.angular_speed, "angular speed");
  positive(options.linear_acceleration, "linear acceleration");
  positive(options.angular_acceleration, "angular acceleration");
  positive(options.force, "largest force");
  positive(options.torque, "largest torque");
  positive(options.damper, "damper");
  positive(options.slip.friction, "friction");
  positive(options.slip.lever, "lever of friction");
  if (!(options.slip.pinch >= 0) || !(options.clearance >= 0) || !(options.pivot >= 0))
    throw std::invalid_argument("pinch, clearance and pivot must not be negative");
  if (!(options.slip.normal_G.norm() > 1e-6))
    throw std::invalid_argument("the normal of a pinch must not be zero");
  options_.slip.normal_G.normalize();
  if (!(options.workspace_lower.array() < options.workspace_upper.array()).all())
    throw std::invalid_argument("the workspace of a motion is empty");
  if (options.obstacles.size() > kMostObstacles)
    throw std::invalid_argument("at most 4 obstacles can be kept away from");
  for (const Obstacle& obstacle : options.obstacles) positive(obstacle.radius, "obstacle's radius");
  if (grasps_.empty() || grasps_.size() > 2)
    throw std::invalid_argument("one or two grasps can move");
}

double MotionLimits::ease(const elasticity::DeformationModel& model) noexcept {
  const elasticity::Sensitivity& sensitivity = model.sensitivity();
  if (!sensitivity.valid || options_.pivot == 0) return 1;
  if (first_pivot_ == 0) first_pivot_ = sensitivity.smallest_pivot;
  if (!(first_pivot_ > 0)) return 1;
  const double share = sensitivity.smallest_pivot / first_pivot_;
  return std::clamp((share / options_.pivot - 0.25) / 0.75, 0.0, 1.0);
}

void MotionLimits::add_to(QuadraticProgram& program, const LawInputs& inputs, const Motion& before,
                          const Motion& scale) noexcept {
  add_speed(program, inputs, before, scale, inputs.model == nullptr ? 1 : ease(*inputs.model));
  if (inputs.model == nullptr || !inputs.model->sensitivity().valid) return;
  for (int moving = 0; moving < static_cast<int>(grasps_.size()); ++moving)
    add_wrench(program, inputs, scale, moving);
  for (const Obstacle& obstacle : options_.obstacles)
    add_obstacle(program, *inputs.model, scale, obstacle);
  for (int moving = 0; moving < static_cast<int>(grasps_.size()); ++moving) {
    const Eigen::Vector3d p = inputs.X_OG[grasps_[moving]].translation();
    for (int axis = 0; axis < 3; ++axis) {
      const int variable = 6 * moving + axis;
      program.add_bound(
          variable, options_.damper * (options_.workspace_lower[axis] - p[axis]) / scale[variable],
          options_.damper * (options_.workspace_upper[axis] - p[axis]) / scale[variable],
          kWorkspace);
    }
  }
}

/// Each component on its own, so that most rows are bounds, and the speed along the way that the
/// hand goes already, which for a motion that turns slowly is all of it.
void MotionLimits::add_speed(QuadraticProgram& program, const LawInputs& inputs,
                             const Motion& before, const Motion& scale, double ease) noexcept {
  for (int i = 0; i < size(); ++i) {
    const bool linear = i % 6 < 3;
    const double speed = ease * (linear ? options_.linear_speed : options_.angular_speed);
    const double change =
        inputs.dt * (linear ? options_.linear_acceleration : options_.angular_acceleration);
    // What was too fast comes down as fast as it may.
    const double lower = std::min(std::max(-speed, before[i] - change), before[i] + change);
    const double upper = std::max(std::min(speed, before[i] + change), before[i] - change);
    program.add_bound(i, lower / scale[i], upper / scale[i]);
  }
  for (int i = 0; i < size(); i += 3) {
    const bool linear = i % 6 < 3;
    const double speed = ease * (linear ? options_.linear_speed : options_.angular_speed);
    const double change =
        inputs.dt * (linear ? options_.linear_acceleration : options_.angular_acceleration);
    const Eigen::Vector3d way = before.segment<3>(i);
    const double now = way.norm();
    Row row = Row::Zero(1, size());
    if (now > 0) row.segment<3>(i) = way.transpose() / now;
    for (int k = i; k < i + 3; ++k) row[k] *= scale[k];
    program.add_row(row, -QuadraticProgram::kNoBound, std::max(speed, now - change));
  }
}

void MotionLimits::add_wrench(QuadraticProgram& program, const LawInputs& inputs,
                              const Motion& scale, int moving) noexcept {
  const int grasp = grasps_[moving];
  // d wrench / d motion, of this hand by all that move.
  Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 12> K(6, size());
  for (int other = 0; other < static_cast<int>(grasps_.size()); ++other)
    K.middleCols<6>(6 * other) = inputs.model->sensitivity().dw_dxi[grasp][grasps_[other]];
  for (int column = 0; column < size(); ++column) K.col(column) *= scale[column];
  const math::Vector6d w = inputs.reaction[grasp].vector();
  for (int i = 0; i < 6; ++i) {
    const double limit = i < 3 ? options_.force : options_.torque;
    program.add_row(K.row(i), options_.damper * (-limit - w[i]), options_.damper * (limit - w[i]),
                    kGrasp);
  }
  const SlipCone& slip = options_.slip;
  if (slip.pinch == 0) return;
  const Eigen::Vector3d normal = inputs.X_OG[grasp].linear() * slip.normal_G;
  const Eigen::Vector3d side = normal.unitOrthogonal();
  const Eigen::Vector3d other_side = normal.cross(side);
  const double held = 2 * slip.friction * slip.pinch;  // by two fingers
  const double inscribed = std::cos(M_PI / kFacets);
  for (int facet = 0; facet < 2 * kFacets; ++facet) {
    const double angle = 2 * M_PI * (facet / 2) / kFacets;
    const double turn = (facet % 2 == 0 ? 1 : -1) / slip.lever;
    math::Vector6d across;
    across << (std::cos(angle) * side + std::sin(angle) * other_side) / inscribed, turn * normal;
    Row row = across.transpose() * K;
    program.add_row(row, -QuadraticProgram::kNoBound, options_.damper * (held - across.dot(w)),
                    kGrasp);
  }
}

void MotionLimits::add_obstacle(QuadraticProgram& program,
                                const elasticity::DeformationModel& model, const Motion& scale,
                                const Obstacle& obstacle) noexcept {
  // The nearest nodes, nearest first: of the whole mesh, since what is inside lies behind the
  // surface.
  std::array<int, kNodesPerObstacle> nearest;
  std::array<double, kNodesPerObstacle> distance;
  nearest.fill(-1);
  distance.fill(QuadraticProgram::kNoBound);
  const Eigen::Matrix3Xd& x = model.positions();
  for (int node = 0; node < x.cols(); ++node) {
    double d = (x.col(node) - obstacle.center_O).squaredNorm();
    int candidate = node;
    for (int k = 0; k < kNodesPerObstacle; ++k) {
      if (d >= distance[k]) continue;
      std::swap(d, distance[k]);
      std::swap(candidate, nearest[k]);
    }
  }
  for (const int node : nearest) {
    if (node < 0) continue;
    const Eigen::Vector3d way = x.col(node) - obstacle.center_O;
    const double from_center = way.norm();
    const Eigen::Vector3d away =
        from_center > 1e-9 ? Eigen::Vector3d(way / from_center) : Eigen::Vector3d::UnitZ();
    Row row = Row::Zero(1, size());
    for (int moving = 0; moving < static_cast<int>(grasps_.size()); ++moving)
      row.segment<6>(6 * moving) =
          away.transpose() * model.sensitivity().dx_dxi[grasps_[moving]].middleRows<3>(3 * node);
    for (int i = 0; i < size(); ++i) row[i] *= scale[i];
    const double gap = from_center - obstacle.radius - options_.clearance;
    program.add_row(row, -options_.damper * gap, QuadraticProgram::kNoBound, kObstacle);
  }
}

}  // namespace palpate::control
