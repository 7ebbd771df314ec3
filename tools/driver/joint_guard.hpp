#pragma once

#include "command_input.hpp"

namespace palpate::driver {

/// Turns the requested motion into joint velocities within all limits. Speeds of all joints are
/// scaled equally, so that the hand keeps its direction. The jerk limit makes joints speed up
/// smoothly: the acceleration grows by at most jerk * period in a cycle, and falls as much towards
/// a constant command. Braking follows the command within the acceleration limit, so that a stop,
/// which palpated's gate also sends as a falling command, is never delayed. Keep this class too, in
/// addition to your arm's own safety functions.
class JointGuard {
 public:
  struct Options {
    double linear_speed = 0.25;  // m/s, of the origin of E
    double angular_speed = 1;    // rad/s
    double speed_share = 0.5;    // of each joint's largest speed
    double acceleration = 5;     // rad/s^2, of each joint
    double jerk = 0;             // rad/s^3, of each joint that speeds up; 0: not limited
    double margin = 0.02;        // rad, margin to both limits of a joint
    double damping = 0.02;  // damping of the inverse near singular poses, which slows the hand down
    double period = 1e-3;   // s
  };

  JointGuard(const kinematics::SerialChain& chain, const Options& options);

  /// For the joints at `q`. Allocates nothing.
  const Joints& limit(const Command& command, const Joints& q);
  /// The arm has been stopped otherwise: the next motion begins at rest.
  void reset() {
    sent_.setZero();
    gained_.setZero();
  }

 private:
  void follow(const math::Twist& V_W_E, const Joints& q);
  void slow_down_near_ends(const Joints& q);
  void change_smoothly();

  kinematics::SerialChain chain_;
  Options options_;
  kinematics::SerialChain::State state_;
  Joints wanted_, sent_;
  Joints gained_;  // acceleration of joints that speed up; else 0
};

}  // namespace palpate::driver
