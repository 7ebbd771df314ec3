#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <vector>

#include "core/math/rigid.hpp"
#include "sim/object/hexahedral_grid.hpp"

namespace palpate::object {

/// Motion of a hand at constant velocity within a step of the plant, from its last pose to the
/// commanded one.
class HandMotion {
 public:
  explicit HandMotion(const math::Pose& X_OG = math::Pose::Identity());

  /// Pose and velocity in O at the end of the next step.
  void send(const math::Pose& X_OG, const math::Twist& V_O_G) noexcept;

  /// Begins a step; advances to the fraction `s` in (0, 1] of it; ends it. Without a further
  /// command the hand then stands still.
  void begin() noexcept;
  void advance(double s) noexcept;
  void end() noexcept;

  /// Stops at the current pose.
  void stop() noexcept;

  const math::Pose& X_OG() const { return X_OG_; }
  const math::Twist& V_O_G() const { return V_O_G_; }

 private:
  math::Pose X_OG_;
  math::Twist V_O_G_;
  math::Pose X_start_;
  math::Twist V_start_;
  Eigen::Quaterniond q_start_ = Eigen::Quaterniond::Identity();
  math::Pose X_end_;
  math::Twist V_end_;
  Eigen::Quaterniond q_end_ = Eigen::Quaterniond::Identity();
};

/// Grasp of the object by a hand.
struct GraspOptions {
  Box patch;                // grasped surface; O, at rest
  int pinch_axis = -1;      // 0, 1, 2: pads only on faces normal to this axis; -1: on all faces
  double stiffness = 20e3;  // N/m, whole patch; large: nearly rigid
  double damping = 2;       // N s/m, whole patch
  /// N, grip force summed over the patch, both sides of a pinch. Infinite: never slips.
  double grip = std::numeric_limits<double>::infinity();
  double friction = 0.8;                          // Coulomb coefficient of the pads on the object
  math::Pose X_OG_rest = math::Pose::Identity();  // pose of the hand while the object is at rest
  /// Of a hand that can open: where it holds the surface when it closes, in G. None: it always
  /// holds the patch.
  std::optional<Box> jaws;
  bool open_at_rest = false;  // with jaws: the hand does not hold the object yet
};

/// Ground truth of a grasp's contact.
struct GraspSlip {
  double share =
      0;  // fraction of the patch's area that slips or has lost contact now; 1: the whole patch
  double distance = 0;  // m, accumulated slip since grasping, mean over the patch's area
  double greatest = 0;  // m, maximum over the nodes
};

/// Pads of a hand: each surface node of the grasp patch is attached to an anchor point fixed to the
/// hand by a spring and a damper, both distributed according to the node's share of the area.
///
/// If the grip is finite, every node carries its share N0 of it. Its spring force f, with n the
/// normal out of the object at rest, rotated with the hand, presses with N = max(0, N0 - n.f).
/// While the tangential force, damper included, stays within friction * N, the node sticks; beyond,
/// it is held at that limit, the damper is off, and the anchor creeps after the node (return
/// mapping of an elastic-plastic spring). A pull along n is limited to N0, where the pad loses
/// contact.
///
/// slide() shifts all anchors on the hand by a script, as if the hand slid along the material.
///
/// A hand with jaws can open; when it closes it holds the part of the surface that is between them
/// then. Each part is as stiff per area as the patch, at most twice so if it is smaller.
class CompliantGrasp {
 public:
  /// A node held by the pads.
  struct Pad {
    int node = 0;
    double area = 0;                                       // m^2
    double stiffness = 0;                                  // N/m, isotropic
    double damping = 0;                                    // N s/m
    double grip = 0;                                       // N
    Eigen::Vector3d normal_G = Eigen::Vector3d::Zero();    // outward from the object
    Eigen::Vector3d p_G = Eigen::Vector3d::Zero();         // the anchor on the hand, before slide()
    Eigen::Vector3d p_O = Eigen::Vector3d::Zero();         // the anchor now, in O
    Eigen::Vector3d velocity_O = Eigen::Vector3d::Zero();  // and its velocity, m/s
    Eigen::Vector3d force_O = Eigen::Vector3d::Zero();     // N, on the object, without the damper
    bool slipping = false;                                 // or lifted off: the damper is off
    double slipped = 0;                                    // m, accumulated slip distance
  };

  /// Grasps the nodes at rest without spring force. Throws std::invalid_argument if the box holds
  /// no surface node or a value is out of range.
  CompliantGrasp(const HexahedralGrid& grid, const GraspOptions& options);

  /// With jaws: lets go of the object.
  void open() noexcept;

  /// With jaws, of an open hand: holds the surface between them at these positions (3 x n, m, in O)
  /// without spring force. The hand remains open if there is none.
  void close(const Eigen::Matrix3Xd& positions) noexcept;

  bool holds() const { return !pads_.empty(); }

  /// Upper bound of the stiffness, N/m, that the pads may ever have at each node, added to
  /// `stiffness`.
  void add_stiffness_bound(Eigen::VectorXd& stiffness) const noexcept;

  /// The hand's motion; the pads follow with advance().
  HandMotion& hand() { return hand_; }
  const HandMotion& hand() const { return hand_; }

  /// Displacement of the hand from where it first held the material (m) and its rate (m/s), both in
  /// G, at the end of the next step. The same nodes stay held.
  void slide(const Eigen::Vector3d& displacement_G, const Eigen::Vector3d& rate_G) noexcept;

  /// Begins a step; advances hand and pads to the fraction `s` in (0, 1] of it; ends it.
  void begin() noexcept;
  void advance(double s) noexcept;
  void end() noexcept;

  /// Stops at the current pose.
  void stop() noexcept;

  /// Adds the pads' forces to `forces`, except their damping by the nodes' own velocities, whose
  /// coefficients it adds to `damping` (N s/m). Determines which nodes slip.
  void add_forces(const Eigen::Matrix3Xd& positions, const Eigen::Matrix3Xd& velocities,
                  Eigen::Matrix3Xd& forces, Eigen::VectorXd& damping) noexcept;

  /// Force of the hand on the object and its torque about the origin of G, in O, for the forces
  /// last added and these velocities.
  math::Wrench wrench(const Eigen::Matrix3Xd& positions,
                      const Eigen::Matrix3Xd& velocities) const noexcept;

  /// Mean wrench over the last step of the plant; written by the plant.
  math::Wrench mean_wrench() const { return mean_wrench_; }
  void set_mean_wrench(const math::Wrench& wrench) noexcept { mean_wrench_ = wrench; }

  GraspSlip slip() const noexcept;
  const std::vector<Pad>& pads() const { return pads_; }

  /// Sum of the magnitudes of the pads' forces, N.
  double force_scale() const noexcept;

 private:
  /// Scripted displacement of the hand along the material.
  struct Slide {
    Eigen::Vector3d now = Eigen::Vector3d::Zero(), start = Eigen::Vector3d::Zero(),
                    end = Eigen::Vector3d::Zero();   // m, in G
    Eigen::Vector3d rate = Eigen::Vector3d::Zero();  // m/s, in G
    bool ever = false;
  };

  /// A node of the surface and its share of it at rest.
  struct Spot {
    int node = 0;
    double area = 0;         // m^2
    Eigen::Vector3d p_O;     // m
    Eigen::Vector3d normal;  // outward, in O
  };
  static std::vector<Spot> spots_in(const HexahedralGrid& grid, const Box& box, int pinch_axis);

  /// `total`: m^2, area over which stiffness, damping and grip are spread.
  void attach(const Spot& spot, double total, const Eigen::Vector3d& position,
              const Eigen::Vector3d& normal_O);
  void update_pads() noexcept;
  void limit(Pad& pad, const Eigen::Vector3d& spring, const Eigen::Vector3d& trial,
             const Eigen::Vector3d& position) noexcept;

  std::vector<Pad> pads_;
  std::vector<Spot> surface_;  // that the jaws may hold
  std::optional<Box> jaws_;
  double stiffness_ = 0, damping_ = 0, grip_ = 0;  // of all pads together
  double patch_area_ = 0;                          // m^2, at rest
  double friction_ = 0;
  bool limited_ = false;
  HandMotion hand_;
  Slide slide_;
  math::Wrench mean_wrench_;
};

}  // namespace palpate::object
