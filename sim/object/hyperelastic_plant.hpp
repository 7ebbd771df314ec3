#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "core/math/rigid.hpp"
#include "sim/object/compliant_grasp.hpp"
#include "sim/object/hexahedral_grid.hpp"
#include "sim/object/neo_hookean_solid.hpp"

namespace palpate::object {

/// What the plant is made of and how it is held. SI units; O is the rest frame of the object.
struct PlantOptions {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // lower corner of the box at rest, m
  Eigen::Vector3d size{0.5, 0.06, 0.06};             // m
  std::array<int, 3> elements{14, 1, 1};             // triquadratic hexahedra per axis
  double young_modulus = 30e3;                       // Pa
  double poisson_ratio = 0.3;                        // [0, 0.5)
  double density = 26;                               // kg/m^3
  double mass_damping = 2;                           // 1/s, force -mass_damping * m * v
  double viscosity = 0;                              // Pa s, Kelvin-Voigt; 0 is faster
  std::optional<Box> clamp;                          // nodes the test rig holds still; O, at rest
  std::optional<Box> grasp;                          // surface patch the hand holds; O, at rest
  double pad_stiffness = 20e3;                       // N/m, whole patch; large: nearly rigid
  double pad_damping = 2;                            // N s/m, whole patch
  math::Pose X_OG_rest = math::Pose::Identity();     // hand while the object is at rest
  Eigen::Vector3d gravity_O = Eigen::Vector3d::Zero();  // m/s^2
  int substeps = 0;                                     // per step(); 0: from the stability limit
};

/// A soft object that the estimator does not know: a compressible Neo-Hookean box of 27-node
/// hexahedra with Gauss-Lobatto lumped mass, integrated by velocity Verlet (explicit, symplectic,
/// of second order; it conserves the momenta of a free undamped body to rounding). Mass and pad
/// damping are taken implicitly, node by node; viscous stress uses the half-step velocity.
///
/// Nothing allocates after construction and every run is bit-for-bit reproducible.
class HyperelasticPlant {
 public:
  /// Result of settle().
  struct Settling {
    double seconds = 0;   // simulated
    double residual = 0;  // |net force on free nodes| / |weight, applied and pad force|
    bool converged = false;
  };

  /// Starts at rest, grasped where a grasp box is given. Throws std::invalid_argument.
  explicit HyperelasticPlant(const PlantOptions& options);

  /// Advances by `dt` s. X_OG and V_O_G are pose and velocity of the hand in O at the end of the
  /// step; within it the hand moves evenly from where it was.
  void step(double dt, const math::Pose& X_OG, const math::Twist& V_O_G) noexcept;

  /// Advances with the hand standing still until the net force is at most `tolerance` of the loads
  /// or `max_seconds` have passed. Motion is taken out whenever the kinetic energy has peaked
  /// (dynamic relaxation with kinetic damping), so the path means nothing, its end the equilibrium.
  Settling settle(double max_seconds, double tolerance = 1e-5) noexcept;

  /// Lets go, or takes hold with no force where hand and object are now.
  void set_grasped(bool grasped) noexcept;
  bool grasped() const { return grasped_; }

  /// Hand on object about the origin of G, in O, averaged over the last step.
  math::Wrench hand_wrench() const { return hand_wrench_; }

  /// Test rig on object about the origin of O, in O, at the end of the last step.
  math::Wrench clamp_wrench() const noexcept;

  /// Adds a force (N, in O) at a material point, applied until clear_forces().
  void add_force(const MaterialPoint& point, const Eigen::Vector3d& force_O) noexcept;
  void clear_forces() noexcept;

  /// Replaces positions (m) and velocities (m/s), both 3 x n in O; clamped nodes are kept still.
  void set_state(const Eigen::Matrix3Xd& positions, const Eigen::Matrix3Xd& velocities);

  const Eigen::Matrix3Xd& positions() const { return positions_; }
  const Eigen::Matrix3Xd& velocities() const { return velocities_; }
  const Eigen::Matrix3Xd& rest_positions() const { return grid_.nodes(); }
  const Eigen::MatrixXi& elements() const { return grid_.elements(); }
  const Eigen::Matrix3Xi& surface_triangles() const { return grid_.triangles(); }
  const Eigen::VectorXd& nodal_masses() const { return masses_; }  // kg
  const std::vector<int>& clamped_nodes() const { return clamped_; }
  const CompliantGrasp& grasp() const { return grasp_; }

  /// Element and weights of a rest point, for repeated use.
  MaterialPoint locate(const Eigen::Vector3d& rest_point) const { return grid_.locate(rest_point); }

  /// Where a rest point is now, m, in O.
  Eigen::Vector3d position_at(const Eigen::Vector3d& rest_point) const {
    return locate(rest_point).interpolate(positions_);
  }

  double kinetic_energy() const noexcept;                                       // J
  double elastic_energy() const noexcept { return solid_.energy(positions_); }  // J
  Eigen::Vector3d linear_momentum() const noexcept;                             // N s
  Eigen::Vector3d angular_momentum() const noexcept;  // N m s, about the origin of O

  /// Longest stable step at rest, held and grasped as built, s.
  double critical_step() const { return critical_step_; }
  int substeps() const { return substeps_; }  // that the last step took

 private:
  void begin_substep(double h) noexcept;  // half a kick, then the drift
  void end_substep(double h) noexcept;    // forces at the new place, the other half of the kick
  void update_forces() noexcept;
  void hold_clamped(Eigen::Matrix3Xd& values, const Eigen::Matrix3Xd& held) const noexcept;
  double find_critical_step() const;
  double load_scale() const noexcept;
  double free_force() const noexcept;
  int stable_substeps(double dt) const noexcept;

  PlantOptions options_;
  HexahedralGrid grid_;
  NeoHookeanSolid solid_;
  CompliantGrasp grasp_;
  std::vector<int> clamped_;
  Eigen::VectorXd masses_;
  Eigen::VectorXd damping_;  // N s/m per node, mass and pad damping
  bool grasped_ = false;
  math::Pose X_OG_;
  math::Twist V_O_G_;
  Eigen::Matrix3Xd positions_;
  Eigen::Matrix3Xd velocities_;
  Eigen::Matrix3Xd applied_;  // N, external forces on nodes
  Eigen::Matrix3Xd driving_;  // N, all forces but the damping by a node's own velocity
  math::Wrench hand_wrench_;
  double stiffening_ = 1;
  double critical_step_ = 0;
  int substeps_ = 1;
};

}  // namespace palpate::object
