#pragma once

#include <cstdint>
#include <palpate/hand_command_t.hpp>
#include <string>
#include <vector>

#include "sim/robot/reactive_grasp.hpp"
#include "sim/robot/robot.hpp"

namespace palpate::scenes {

/// A scheduled command of a scene to the hand.
struct HandAction {
  double at = 0;  // s
  hand_command_t command{};
};

/// The hand's own controller: OPEN opens the fingers, CLOSE closes them reactively into the thesis'
/// force band, HOLD into a band whose upper end is the commanded force. Contact forces are those
/// acting on the fingertips' links (Robot::set_link_load). Until the first command the fingers hold
/// their position.
class HandControl {
 public:
  static constexpr double kMostForce = 20;  // N, largest force of HOLD

  explicit HandControl(const robot::Robot& robot);

  /// False if the command is not feasible for a hand.
  bool accept(const hand_command_t& command);

  /// Call once per tick of 1 ms.
  void step(std::int64_t tick, robot::Robot& robot);

  const robot::ReactiveGrasp& grasp() const { return grasp_; }

  /// What the last command makes the palm's jaws do.
  enum class Jaws { kStay, kOpen, kClose };
  Jaws jaws() const { return jaws_; }

 private:
  std::vector<std::string> tips_;
  robot::ReactiveGrasp grasp_;
  bool commanded_ = false;
  Jaws jaws_ = Jaws::kStay;
};

}  // namespace palpate::scenes
