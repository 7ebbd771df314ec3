#pragma once

#include <Eigen/Core>
#include <string>

#include "core/kinematics/serial_chain.hpp"
#include "core/math/rigid.hpp"

namespace palpate::driver {

using Joints = kinematics::SerialChain::Joints;

/// State of an arm.
struct ArmState {
  Joints q;                // rad (or m), from the base outwards
  Joints dq;               // rad/s
  Joints tau;              // N m; zero if unknown
  math::Wrench wrench_S;   // N, N m: wrench of the sensor on the hand, at the origin of S
  bool has_wrench = true;  // false: a separate driver publishes FT_WRENCH
  bool stopped = false;    // an emergency stop is pressed, or the arm's own safety has stopped it
  const char* stop_reason = "emergency stop";  // printed once while `stopped`
  bool is_new = true;      // false: the state of the last cycle, which is not published again
  bool restarted = false;  // the arm was absent since the last state: palpated waits for start
};

/// Hardware interface: the only class to implement for a new arm. Both functions are called once
/// per cycle of 1 ms by a single thread, and must return within a fraction of it: if the arm's
/// library blocks, give it a separate thread.
class Arm {
 public:
  virtual ~Arm() = default;
  virtual int joint_count() const = 0;
  /// The newest state. False if the arm has not answered: the driver then sends no state, and
  /// commands zero; palpated becomes degraded within 50 ms.
  virtual bool read(ArmState& state) = 0;
  /// Joint velocities until the next call, within all limits, rad/s. Zero is a stop.
  virtual void command(const Joints& dq) = 0;
};

}  // namespace palpate::driver
