#pragma once

#include "messages.hpp"

namespace palpate::franka_bridge {

/// What the arm allows for its joints, in every cycle of 1 ms: beyond it, it stops by a reflex.
struct Limits {
  // Largest speed towards an end: min(most, sqrt(slope (end - q)) - offset), rad/s.
  struct Speed {
    double lower = 0, upper = 0;             // rad, ends
    double most = 0, offset = 0, slope = 0;  // rad/s, rad/s, rad/s^2
  };
  std::array<Speed, kJoints> speed{};
  double acceleration = 0;  // rad/s^2, of each joint
  double jerk = 0;          // rad/s^3, of each joint
};

/// Of a Franka Research 3, as its maker publishes them.
const Limits& fr3_limits();

/// Joint velocities that the arm accepts next, and that follow wanted ones: within its limits of
/// speed by position, acceleration and jerk. Continues what the arm says that it executes, which
/// after a lost command is not the last one sent.
class Follower {
 public:
  explicit Follower(const Limits& limits) : limits_(limits) {}

  /// `wanted`, rad/s; all joints are slowed down alike where one is too fast. `state` is the one
  /// that is answered.
  Seven next(const Seven& wanted, const RobotState& state) const;

 private:
  double next(double wanted, double speed, double acceleration) const;

  Limits limits_;
};

}  // namespace palpate::franka_bridge
