#include "rt/pipeline/obstacle_motion.hpp"

#include <limits>

namespace palpate::pipeline {

using Kind = registry::ObstacleCarrier::Kind;

ObstacleMotion::ObstacleMotion(const std::vector<registry::ConfiguredObstacle>& obstacles,
                               const math::Pose& X_WO)
    : X_WO_(X_WO), X_OW_(X_WO.inverse()) {
  for (const registry::ConfiguredObstacle& obstacle : obstacles) {
    const collision::Obstacle& body = obstacle.limited.body;
    carriers_.push_back(obstacle.carrier);
    placements_.push_back({body.X_OB, body.V_O_B, body.is_known});
    names_.push_back(body.name);
    if (obstacle.carrier.kind == Kind::kMessages) moved_.push_back(body.name);
    ages_.push_back(std::numeric_limits<double>::infinity());
  }
  free_ = registry::free_directions(obstacles);
  displaced_ = placements_;
}

UpdateResult ObstacleMotion::update(const sensing::Signals& signals, bool joints_known,
                                    const collision::FreeMotion& displacement) noexcept {
  UpdateResult result;
  late_ = "";
  for (std::size_t i = 0; i < placements_.size(); ++i) {
    bool is_current = true;
    if (carriers_[i].kind == Kind::kLink)
      is_current = joints_known && follow_link(i, signals.robot.latest);
    if (carriers_[i].kind == Kind::kMessages) is_current = follow_messages(i, signals);
    if (is_current) continue;
    placements_[i].V_O_B = {};
    if (*late_ != '\0') continue;
    late_ = names_[i].c_str();
    result.status = Status::kDegraded;
    if (carriers_[i].kind == Kind::kLink)
      result.reason = "the joints of the arm that carries this obstacle are not known";
    else if (placements_[i].is_known && ages_[i] < std::numeric_limits<double>::infinity())
      result.reason = "no message moves this obstacle any more";
    else
      result.reason = "no message has moved this obstacle yet";
  }
  displaced_ = placements_;
  collision::displace(free_, displacement, displaced_);
  return result;
}

bool ObstacleMotion::follow_link(std::size_t index, const sensing::RobotState& robot) noexcept {
  const registry::ObstacleCarrier& carrier = carriers_[index];
  const int n = carrier.link->joint_count();
  carrier.link->evaluate(robot.q.head(n), kinematics_);
  const math::Pose X_WB = kinematics_.X_WE * carrier.X_AB;
  const math::Twist V_W_A = math::Twist::from(kinematics_.J_W_E.lazyProduct(robot.dq.head(n)));
  const Eigen::Vector3d offset = X_WB.translation() - kinematics_.X_WE.translation();
  set(index, X_WB, math::move_reference(V_W_A, offset));
  return true;
}

/// The newest message of this tick, or the last pose, moved on.
bool ObstacleMotion::follow_messages(std::size_t index, const sensing::Signals& signals) noexcept {
  const sensing::ObstacleState* newest = nullptr;
  for (int i = 0; i < signals.world.fresh_count; ++i) {
    const sensing::ObstacleState& state = signals.world.fresh[static_cast<std::size_t>(i)];
    if (names_[index] == state.name.data()) newest = &state;
  }
  if (newest != nullptr) {
    ages_[index] = 0;
    set(index, newest->X_WB, newest->V_W_B);
    return true;
  }
  ages_[index] += signals.dt;
  if (ages_[index] > carriers_[index].timeout) return false;
  collision::Placement& placement = placements_[index];
  placement.X_OB.translation() += signals.dt * placement.V_O_B.linear;
  placement.X_OB.linear() =
      math::exp_rotation(signals.dt * placement.V_O_B.angular) * placement.X_OB.linear();
  return true;
}

void ObstacleMotion::set(std::size_t index, const math::Pose& X_WB,
                         const math::Twist& V_W_B) noexcept {
  placements_[index] = {
      X_OW_ * X_WB, {X_OW_.linear() * V_W_B.linear, X_OW_.linear() * V_W_B.angular}, true};
}

}  // namespace palpate::pipeline
