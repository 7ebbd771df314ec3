#pragma once

#include <cstdint>
#include <palpate/hand_command_t.hpp>
#include <string>
#include <vector>

#include "sim/robot/reactive_grasp.hpp"
#include "sim/robot/robot.hpp"

namespace palpate::scenes {

/// Something that a scene tells the hand to do.
struct HandAction {
  double at = 0;  // s
  hand_command_t command{};
};

/// The hand's own controller: OPEN opens the fingers, CLOSE closes them reactively into the thesis'
/// force band, HOLD into a band whose upper end is the force commanded. Contact forces are those
/// that act on the fingertips' links (Robot::set_link_load). Until the first command the fingers
/// keep their place.
class HandControl {
 public:
  static constexpr double kMostForce = 20;  // N, that HOLD may ask for

  explicit HandControl(const robot::Robot& robot);

  /// False where the command asks for something that no hand can do.
  bool accept(const hand_command_t& command);

  /// Once a tick of 1 ms.
  void step(std::int64_t tick, robot::Robot& robot);

  const robot::ReactiveGrasp& grasp() const { return grasp_; }

 private:
  std::vector<std::string> tips_;
  robot::ReactiveGrasp grasp_;
  bool commanded_ = false;
};

}  // namespace palpate::scenes
