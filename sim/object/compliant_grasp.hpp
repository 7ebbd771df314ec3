#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/math/rigid.hpp"
#include "sim/object/hexahedral_grid.hpp"

namespace palpate::object {

/// Pads of the hand: each surface node of the grasp patch hangs on a point fixed to the hand by a
/// spring and a damper, both shared out by the area that the node stands for.
class CompliantGrasp {
 public:
  /// One node held by the pad.
  struct Pad {
    int node = 0;
    double stiffness = 0;                                  // N/m, isotropic
    double damping = 0;                                    // N s/m
    Eigen::Vector3d p_G = Eigen::Vector3d::Zero();         // the point of the hand it hangs on
    Eigen::Vector3d p_O = Eigen::Vector3d::Zero();         // that point now, in O
    Eigen::Vector3d velocity_O = Eigen::Vector3d::Zero();  // and its velocity, m/s
  };

  CompliantGrasp() = default;

  /// stiffness (N/m) and damping (N s/m) are those of the whole patch. Throws
  /// std::invalid_argument where the box holds no surface node or a value is negative.
  CompliantGrasp(const HexahedralGrid& grid, const Box& patch, double stiffness, double damping);

  /// Fixes the pads to the hand where the nodes are now: no spring force at this instant.
  void attach(const math::Pose& X_OG, const Eigen::Matrix3Xd& positions) noexcept;

  /// Moves the hand: pose and velocity of G in O.
  void move(const math::Pose& X_OG, const math::Twist& V_O_G) noexcept;

  /// Force of the hand on the object and its torque about the origin of G, in O.
  math::Wrench wrench(const Eigen::Matrix3Xd& positions,
                      const Eigen::Matrix3Xd& velocities) const noexcept;

  const std::vector<Pad>& pads() const { return pads_; }

 private:
  std::vector<Pad> pads_;
  Eigen::Vector3d p_OG_ = Eigen::Vector3d::Zero();
};

}  // namespace palpate::object
