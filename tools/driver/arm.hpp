#pragma once

#include <Eigen/Core>
#include <string>

#include "core/kinematics/serial_chain.hpp"
#include "core/math/rigid.hpp"

namespace palpate::driver {

using Joints = kinematics::SerialChain::Joints;

/// What an arm tells of itself.
struct ArmState {
  Joints q;                // rad (or m), from the base on
  Joints dq;               // rad/s
  Joints tau;              // N m; zero where it is not known
  math::Wrench wrench_S;   // N, N m: what the sensor exerts on the hand, at the origin of S
  bool has_wrench = true;  // false: a driver of its own publishes FT_WRENCH
  bool stopped = false;    // an emergency stop is pressed, or the arm's own safety has stopped it
};

/// The seam to hardware: the only class to write for an arm of your own. Both functions are called
/// once in a cycle of 1 ms by one thread, the same one, and must not wait for longer than a part of
/// it: where the arm's library blocks, give it a thread of its own.
class Arm {
 public:
  virtual ~Arm() = default;
  virtual int joint_count() const = 0;
  /// The newest state. False where the arm has not answered: the driver then sends no state, and
  /// commands zero; palpated becomes degraded within 50 ms.
  virtual bool read(ArmState& state) = 0;
  /// Velocities of the joints from now on, within all limits, rad/s. Zero is a stop.
  virtual void command(const Joints& dq) = 0;
};

}  // namespace palpate::driver
