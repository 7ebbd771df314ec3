#pragma once

#include <array>

#include "core/kinematics/serial_chain.hpp"

namespace palpate::sensing {

/// Friction of an arm's joints as a drive's torque contains it: viscous friction, and Coulomb
/// friction that builds up elastically after a joint has turned back, as in the model of Dahl
/// (1968). The build-up is the mean of elasto-plastic elements (a Prandtl-Ishlinskii model): unlike
/// Dahl's equation it is not worn down by the noise of a joint at rest, where the friction keeps
/// the value that the last motion left. Before a joint has moved by four times `presliding` in one
/// direction only bounds are known, which every motion narrows. Nothing allocates.
class JointFriction {
 public:
  using Joints = kinematics::SerialChain::Joints;
  struct Options {
    Joints coulomb;  // N m, per joint, at least 0
    Joints viscous;  // N m s/rad, likewise
    /// rad, rotation over which all but 37 % of a difference from the Coulomb friction vanishes
    double presliding = 3e-4;
    double error = 0.1;  // relative standard deviation of the friction of a sliding joint
  };

  /// Throws std::invalid_argument naming the invalid option.
  explicit JointFriction(const Options& options);

  /// Nothing is known of the Coulomb friction but its bounds.
  void reset() noexcept;
  /// The joints have moved to `q`, rad, with velocity `dq`, rad/s. After a gap, in which they may
  /// have moved in any way, call reset() first.
  void follow(const Joints& q, const Joints& dq) noexcept;

  const Joints& torque() const noexcept { return torque_; }        // N m
  const Joints& deviation() const noexcept { return deviation_; }  // N m, standard
  /// Whether the bounds have met in all joints with friction.
  bool is_known() const noexcept { return known_; }

 private:
  static constexpr int kElements = 4;
  /// Bounds of the force of each element of a joint over its largest, -1 to 1.
  struct Elements {
    std::array<double, kElements> lower, upper;
  };

  Options options_;
  bool has_position_ = false, known_ = false;
  Joints q_;
  std::array<Elements, kinematics::SerialChain::kMostJoints> elements_;
  Joints torque_, deviation_;
};

}  // namespace palpate::sensing
