#pragma once

#include <string>
#include <vector>

#include "core/collision/free_directions.hpp"
#include "core/math/update_result.hpp"
#include "core/sensing/signals.hpp"
#include "rt/registry/obstacles.hpp"

namespace palpate::pipeline {

/// Where the obstacles of the configuration are in each tick: fixed, carried by links of the arm,
/// or moved by messages on WORLD_STATE, between which they keep their velocity for the time-out at
/// most; displaced as an estimate of their free directions says. An obstacle whose place is unknown
/// stays where it was last. Nothing allocates after construction.
class ObstacleMotion {
 public:
  ObstacleMotion(const std::vector<registry::ConfiguredObstacle>& obstacles,
                 const math::Pose& X_WO);

  /// `signals`: of the first arm. `joints_known`: its joints are reported and are those of its
  /// model. `displacement`: of obstacles from the poses that configuration, joints and messages
  /// give. Degraded while an obstacle's place is unknown: late() names it.
  UpdateResult update(const sensing::Signals& signals, bool joints_known,
                      const collision::FreeMotion& displacement = {}) noexcept;

  /// Of each obstacle, in the order of the configuration.
  const std::vector<collision::Placement>& placements() const noexcept { return displaced_; }
  /// The same poses in W.
  math::Pose X_WB(std::size_t obstacle) const noexcept { return X_WO_ * displaced_[obstacle].X_OB; }
  const std::vector<collision::FreeDirection>& free_directions() const noexcept { return free_; }
  /// Name of an obstacle whose place is unknown since the last update; "" if there is none.
  const char* late() const noexcept { return late_; }
  /// Names of all obstacles, and of those that messages move.
  const std::vector<std::string>& names() const noexcept { return names_; }
  const std::vector<std::string>& moved() const noexcept { return moved_; }

 private:
  bool follow_link(std::size_t index, const sensing::RobotState& robot) noexcept;
  bool follow_messages(std::size_t index, const sensing::Signals& signals) noexcept;
  void set(std::size_t index, const math::Pose& X_WB, const math::Twist& V_W_B) noexcept;

  math::Pose X_WO_, X_OW_;
  std::vector<registry::ObstacleCarrier> carriers_;
  std::vector<collision::FreeDirection> free_;
  std::vector<collision::Placement> placements_, displaced_;
  std::vector<std::string> names_, moved_;
  std::vector<double> ages_;  // s since the last message
  kinematics::SerialChain::State kinematics_;
  const char* late_ = "";
};

}  // namespace palpate::pipeline
