#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "core/math/rigid.hpp"
#include "sim/object/hand_motion.hpp"
#include "sim/object/hexahedral_grid.hpp"

namespace palpate::object {

/// How a hand holds the object.
struct GraspOptions {
  Box patch;                // the surface it holds; O, at rest
  int pinch_axis = -1;      // 0, 1, 2: pads only on faces across this axis; -1: on all faces
  double stiffness = 20e3;  // N/m, whole patch; large: nearly rigid
  double damping = 2;       // N s/m, whole patch
  /// N, how hard the pads press, summed over the patch: both sides of a pinch. Infinite: never
  /// slips.
  double grip = std::numeric_limits<double>::infinity();
  double friction = 0.8;                          // Coulomb, of the pads on the object
  math::Pose X_OG_rest = math::Pose::Identity();  // hand while the object is at rest
};

/// Truth about the hold of a grasp.
struct GraspSlip {
  double share = 0;     // of the patch's area that slips or has lost touch now; 1: the whole patch
  double distance = 0;  // m, slipped since the hand took hold, mean over the patch's area
  double greatest = 0;  // m, of any node
};

/// Pads of a hand: each surface node of the grasp patch hangs on a point fixed to the hand by a
/// spring and a damper, both shared out by the area that the node stands for.
///
/// Where the grip is finite every node bears its share N0 of it. Its spring force f with the normal
/// n out of the object at rest, carried along by the hand, presses with N = max(0, N0 - n.f). While
/// the force across n, damper included, stays within friction * N the node sticks; beyond, it is
/// held at that limit, the damper gives way, and the point of the hand creeps after the node
/// (return mapping of an elastic-plastic spring). A pull along n ends at N0, where the pad loses
/// touch.
class CompliantGrasp {
 public:
  /// One node held by the pads.
  struct Pad {
    int node = 0;
    double area = 0;                                       // m^2
    double stiffness = 0;                                  // N/m, isotropic
    double damping = 0;                                    // N s/m
    double grip = 0;                                       // N
    Eigen::Vector3d normal_G = Eigen::Vector3d::Zero();    // out of the object
    Eigen::Vector3d p_G = Eigen::Vector3d::Zero();         // the point of the hand it hangs on
    Eigen::Vector3d p_O = Eigen::Vector3d::Zero();         // that point now, in O
    Eigen::Vector3d velocity_O = Eigen::Vector3d::Zero();  // and its velocity, m/s
    Eigen::Vector3d force_O = Eigen::Vector3d::Zero();     // N, on the object, but for the damper
    bool slipping = false;                                 // or lifted: the damper is off
    double slipped = 0;                                    // m, length of the path
  };

  /// Throws std::invalid_argument where the box holds no surface node or a value is out of range.
  CompliantGrasp(const HexahedralGrid& grid, const GraspOptions& options);

  /// Takes hold of the nodes where they are, with no spring force at this instant; lets go.
  void hold(const Eigen::Matrix3Xd& positions) noexcept;
  void release() noexcept;
  bool holding() const { return holding_; }

  /// The hand's motion; the pads follow with update_pads().
  HandMotion& hand() { return hand_; }
  const HandMotion& hand() const { return hand_; }
  void update_pads() noexcept;

  /// Adds the pads' forces to `forces`, all but their damping by the nodes' own velocities, whose
  /// coefficients it adds to `damping` (N s/m). Decides what slips.
  void add_forces(const Eigen::Matrix3Xd& positions, const Eigen::Matrix3Xd& velocities,
                  Eigen::Matrix3Xd& forces, Eigen::VectorXd& damping) noexcept;

  /// Force of the hand on the object and its torque about the origin of G, in O, with the forces
  /// last added and these velocities.
  math::Wrench wrench(const Eigen::Matrix3Xd& positions,
                      const Eigen::Matrix3Xd& velocities) const noexcept;

  /// Mean of the wrench over the last step of the plant; written by it.
  math::Wrench mean_wrench() const { return mean_wrench_; }
  void set_mean_wrench(const math::Wrench& wrench) noexcept { mean_wrench_ = wrench; }

  GraspSlip slip() const noexcept;
  const std::vector<Pad>& pads() const { return pads_; }

  /// Sum of the magnitudes of the pads' forces, N.
  double force_scale() const noexcept;

 private:
  void limit(Pad& pad, const Eigen::Vector3d& spring, const Eigen::Vector3d& trial,
             const Eigen::Vector3d& position) noexcept;

  std::vector<Pad> pads_;
  double friction_ = 0;
  bool limited_ = false;
  bool holding_ = true;
  HandMotion hand_;
  math::Wrench mean_wrench_;
};

}  // namespace palpate::object
