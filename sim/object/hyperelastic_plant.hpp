#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/math/rigid.hpp"
#include "sim/object/compliant_grasp.hpp"
#include "sim/object/contact_surface.hpp"
#include "sim/object/fingertip_contact.hpp"
#include "sim/object/hexahedral_grid.hpp"
#include "sim/object/neo_hookean_solid.hpp"
#include "sim/object/obstacle_contact.hpp"
#include "sim/object/plant.hpp"

namespace palpate::object {

/// Springs and dampers between the clamp and the clamped surface, spread over its area.
struct ClampPads {
  double stiffness = 1e4;  // N/m, together, in each direction
  double damping = 2;      // N s/m, together
};

/// Material and boundary conditions of the plant. SI units; O is the rest frame of the object.
struct PlantOptions {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // lower corner of the box at rest, m
  Eigen::Vector3d size{0.5, 0.06, 0.06};             // m
  std::array<int, 3> elements{14, 1, 1};             // triquadratic hexahedra per axis
  double grading = 1;  // growth of element lengths away from clamp and grasps; 1: all are equal
  double young_modulus = 30e3;               // Pa
  double poisson_ratio = 0.3;                // [0, 0.5)
  double density = 26;                       // kg/m^3
  double mass_damping = 2;                   // 1/s, force -mass_damping * m * v
  double viscosity = 0;                      // Pa s, Kelvin-Voigt; 0 is faster
  std::vector<MaxwellBranch> maxwell;        // creep and relaxation
  std::optional<Yield> yield;                // for an object that does not recover its shape
  std::vector<ModulusRegion> regions;        // parts of a different stiffness
  StiffnessFieldOptions stiffness_field;     // random variation of the modulus
  std::optional<Box> clamp;                  // nodes fixed by the test rig; O, at rest
  std::optional<ClampPads> clamp_pads;       // between clamp and object; none: the nodes are fixed
  std::vector<GraspOptions> grasps;          // hands, at most kMostGrasps
  std::vector<FingertipOptions> fingertips;  // that may touch the object
  std::vector<ObstacleOptions> obstacles;    // that it may touch; they are everywhere at rest
  Eigen::Vector3d gravity_O = Eigen::Vector3d::Zero();  // m/s^2
  int substeps = 0;                                     // per step(); 0: from the stability limit

  static constexpr std::size_t kMostGrasps = 2;
};

/// A soft object that is independent of the estimator's model: a compressible Neo-Hookean box of
/// 27-node hexahedra with Gauss-Lobatto lumped mass, integrated by velocity Verlet (explicit,
/// symplectic, second order; it conserves the momenta of a free undamped body to rounding).
/// Mass-proportional and pad damping are implicit, node by node; viscous stress uses the half-step
/// velocity. Substeps stay within the stability limit, which is checked after each of them.
///
/// No allocation after construction; every run is bit-for-bit reproducible.
class HyperelasticPlant final : public Plant {
 public:
  /// Result of settle().
  struct Settling {
    double seconds = 0;   // simulated
    double residual = 0;  // |net force on free nodes| / |weight, applied and pad force|
    bool converged = false;
  };

  /// Starts at rest, held by every given hand. Throws std::invalid_argument.
  explicit HyperelasticPlant(const PlantOptions& options);

  /// Advances by `dt` s. Hands and fingertips move at constant velocity to their commanded poses;
  /// those without a command since the last step stand still.
  void step(double dt) noexcept override;

  /// The same after move_hand(0, X_OG, V_O_G).
  void step(double dt, const math::Pose& X_OG, const math::Twist& V_O_G) noexcept;

  /// Pose and velocity of a hand in O at the end of the next step. `hand` < grasp_count().
  void move_hand(int hand, const math::Pose& X_OG, const math::Twist& V_O_G) noexcept override;

  void slide_hand(int hand, const Eigen::Vector3d& displacement_G,
                  const Eigen::Vector3d& rate_G) noexcept override {
    grasps_[hand].slide(displacement_G, rate_G);
  }

  /// Centre and velocity of a fingertip in O at the end of the next step; the first call places it
  /// there immediately. Tips are absent until moved.
  void move_fingertip(int tip, const Eigen::Vector3d& centre,
                      const math::Twist& velocity) noexcept override;

  /// Ground truth of a tip's contact; wrench on the tip about its centre, in O: mean over the last
  /// step.
  const FingertipContact& fingertip(int tip) const { return fingertips_[tip]; }
  int fingertip_count() const override { return static_cast<int>(fingertips_.size()); }
  const FingertipTouch& touch(int tip) const override { return fingertips_[tip].touch(); }
  Eigen::Vector3d fingertip_centre(int tip) const override { return fingertips_[tip].centre(); }
  math::Wrench fingertip_wrench(int tip) const override { return fingertips_[tip].mean_wrench(); }

  /// Advances with the hands standing still until the net force is at most `tolerance` of the loads
  /// or `max_seconds` have passed. Velocities are zeroed at each peak of the kinetic energy
  /// (dynamic relaxation with kinetic damping), so the path has no meaning, only the final
  /// equilibrium. Maxwell branches end up relaxed. Yield and slip on that path are permanent: step
  /// with damping if that matters.
  Settling settle(double max_seconds, double tolerance = 1e-5) noexcept;

  bool grasped(int hand = 0) const override {
    return hand < grasp_count() && grasps_[hand].holds();
  }
  void open_hand(int hand) noexcept override { grasps_[hand].open(); }
  void close_hand(int hand) noexcept override { grasps_[hand].close(positions_); }

  /// Wrench of the hand on the object about the origin of its G, in O, averaged over the last step.
  math::Wrench hand_wrench(int hand = 0) const override {
    return hand < grasp_count() ? grasps_[hand].mean_wrench() : math::Wrench();
  }

  /// Pads and slip of a hand. `hand` < grasp_count().
  const CompliantGrasp& grasp(int hand = 0) const { return grasps_[hand]; }
  double slipping_share(int hand) const override { return grasps_[hand].slip().share; }
  int grasp_count() const override { return static_cast<int>(options_.grasps.size()); }

  /// Wrench of the test rig on the object about the origin of O, in O, at the end of the last step.
  math::Wrench clamp_wrench() const noexcept;

  /// Ground truth of the contact with an obstacle, with the wrench on the object about the origin
  /// of O, now and averaged over the last step.
  int obstacle_count() const { return static_cast<int>(obstacles_.size()); }
  const ObstacleContact& obstacle(int index) const { return obstacles_[index]; }

  /// Adds a force (N, in O) at a material point, applied until clear_forces().
  void add_force(const MaterialPoint& point, const Eigen::Vector3d& force_O) noexcept;
  void push(const Eigen::Vector3d& rest_point, const Eigen::Vector3d& force) noexcept override {
    add_force(locate(rest_point), force);
  }
  void clear_forces() noexcept override;

  /// Cuts the material within the box at rest. Throws std::invalid_argument if the box holds none.
  void cut(const Box& box) { solid_.cut(grid_, box); }

  /// Replaces positions (m) and velocities (m/s), both 3 x n in O; clamped nodes are kept fixed.
  void set_state(const Eigen::Matrix3Xd& positions, const Eigen::Matrix3Xd& velocities);

  const Eigen::Matrix3Xd& positions() const override { return positions_; }
  const Eigen::Matrix3Xd& velocities() const { return velocities_; }
  const Eigen::Matrix3Xd& rest_positions() const override { return grid_.nodes(); }
  const Eigen::MatrixXi& elements() const override { return grid_.elements(); }
  const Eigen::Matrix3Xi& surface_triangles() const override { return grid_.triangles(); }
  const Eigen::VectorXd& nodal_masses() const { return masses_; }  // kg
  const std::vector<int>& clamped_nodes() const override { return clamped_; }
  std::vector<std::string> remarks() const override;

  /// Element and weights of a rest point, for repeated use.
  MaterialPoint locate(const Eigen::Vector3d& rest_point) const { return grid_.locate(rest_point); }

  /// Current position of a rest point, m, in O.
  Eigen::Vector3d position_at(const Eigen::Vector3d& rest_point) const {
    return locate(rest_point).interpolate(positions_);
  }

  double kinetic_energy() const noexcept;                                       // J
  double elastic_energy() const noexcept { return solid_.energy(positions_); }  // J
  double greatest_plastic_strain() const { return solid_.greatest_plastic_strain(); }

  /// Longest stable step at rest, held and grasped as constructed, without contact, s.
  double critical_step() const { return critical_step_; }
  int substeps() const override { return substeps_; }  // taken by the last step

 private:
  void begin_substep(
      double h) noexcept;  // first half-step velocity update, then the position update
  void end_substep(double h,
                   double h_material) noexcept;  // forces there, second half-step velocity update
  void update_forces(double h, double h_material) noexcept;
  void add_wrenches(double weight) noexcept;
  void add_grasps();
  void add_fingertips();
  void add_obstacles();
  double stable_step() const noexcept;
  double load_scale() const noexcept;
  double free_force() const noexcept;

  PlantOptions options_;
  HexahedralGrid grid_;
  NeoHookeanSolid solid_;
  ContactSurface surface_;
  std::vector<CompliantGrasp> grasps_;  // of the hands, then of a clamp with pads
  std::vector<FingertipContact> fingertips_;
  std::vector<ObstacleContact> obstacles_;
  std::vector<int> clamped_;
  std::vector<int> fixed_;   // clamped without pads
  std::vector<int> padded_;  // nodes that pads may hold, without repetition
  Eigen::VectorXd masses_;
  Eigen::Matrix3Xd inverse_masses_;    // 1/kg, by coordinate
  Eigen::Matrix3Xd weight_;            // N
  Eigen::VectorXd pad_damping_;        // N s/m per node
  Eigen::VectorXd contact_stiffness_;  // N/m per node, bound on that of fingertips and obstacles
  Eigen::Matrix3Xd positions_;
  Eigen::Matrix3Xd velocities_;
  Eigen::Matrix3Xd applied_;  // N, external forces on nodes
  Eigen::Matrix3Xd driving_;  // N, all forces except damping by a node's own velocity
  Eigen::Matrix<double, 6, Eigen::Dynamic> hand_sums_;  // of the wrenches within a step
  Eigen::Matrix<double, 6, Eigen::Dynamic> tip_sums_;
  double stiffening_ = 1;
  double critical_step_ = 0;
  int substeps_ = 1;
};

}  // namespace palpate::object
