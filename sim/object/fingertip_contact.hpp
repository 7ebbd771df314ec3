#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/math/rigid.hpp"
#include "sim/object/contact_surface.hpp"

namespace palpate::object {

/// A spherical fingertip.
struct FingertipOptions {
  double radius = 8e-3;        // m
  double stiffness = 0;        // Pa/m, pressure per penetration; 0: 50 E / radius
  double shear_stiffness = 0;  // Pa/m, tangential while sticking, per contact area; 0: half of that
  double friction = 0.8;       // Coulomb
};

/// Ground truth of a fingertip's contact at the end of a step, in O.
struct FingertipTouch {
  bool touching = false;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();     // N, on the tip
  Eigen::Vector3d friction = Eigen::Vector3d::Zero();  // N, component tangential to `normal`
  Eigen::Vector3d point = Eigen::Vector3d::Zero();     // centre of pressure, m
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();    // out of the object, into the tip
  double area = 0;   // m^2, rest area of the surface under pressure
  double depth = 0;  // m, largest penetration
  bool sticking = false;
  double slipped = 0;  // m, since contact began
};

/// A sphere pressed against the deformed surface of the object.
///
/// Every surface sample of area A at a depth d below the sphere bears the pressure stiffness * d
/// along the sphere's radius: the gradient of the energy sum A stiffness d^2 / 2. Friction is one
/// tangential spring of stiffness shear_stiffness * contact area at the centre of pressure, loaded
/// by the tip's motion relative to the material there, with its force limited to friction * |normal
/// force| (regularised Coulomb); it is distributed to the material like the normal force. New
/// contact area is unloaded and lost area takes its share of the force along, as in Mindlin's
/// contact, so that neither adds energy. Force and torque on tip and object balance to rounding.
/// The tip rotates with its twist but has no torsional friction.
class FingertipContact {
 public:
  /// Throws std::invalid_argument if a value is out of range; stiffnesses must be given.
  FingertipContact(const FingertipOptions& options, const ContactSurface& surface);

  /// Centre (m) and velocity of the tip in O at the end of the next step. The first call places the
  /// tip there immediately.
  void send(const Eigen::Vector3d& centre, const math::Twist& velocity) noexcept;
  bool present() const { return present_; }

  /// Begins a step; advances to the fraction `s` in (0, 1] of it; ends it.
  void begin() noexcept;
  void advance(double s) noexcept;
  void end() noexcept;

  /// Stops at the current position.
  void stop() noexcept;

  /// Adds the nodal forces, `h` s after the last call, and to `stiffness` (N/m) an upper bound on
  /// the row sums of the stiffness that it adds, or may add before the next step. `velocities` are
  /// mean values over those h s.
  void add_forces(const ContactSurface& surface, const Eigen::Matrix3Xd& positions,
                  const Eigen::Matrix3Xd& velocities, double h, Eigen::Matrix3Xd& forces,
                  Eigen::VectorXd& stiffness) noexcept;

  const FingertipTouch& touch() const { return touch_; }

  /// Wrench on the tip about its centre, in O, now and averaged over the last step of the plant.
  math::Wrench wrench() const noexcept;
  math::Wrench mean_wrench() const { return mean_wrench_; }
  void set_mean_wrench(const math::Wrench& wrench) noexcept { mean_wrench_ = wrench; }

  const Eigen::Vector3d& centre() const { return centre_; }
  double radius() const { return options_.radius; }

  /// Energy of penetration and of the tangential spring, J.
  double energy() const noexcept;

 private:
  struct Share {  // share of the normal force, by the nodes of a face
    int face = 0;
    Eigen::Matrix<double, 9, 1> weights;
  };

  void press(const ContactSurface& surface, const Eigen::Matrix3Xd& positions,
             Eigen::Matrix3Xd& forces, Eigen::VectorXd& stiffness) noexcept;
  void drag(const ContactSurface& surface, const Eigen::Matrix3Xd& velocities, double h,
            Eigen::Matrix3Xd& forces, Eigen::VectorXd& stiffness) noexcept;

  FingertipOptions options_;
  bool present_ = false;
  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();
  math::Twist velocity_;
  Eigen::Vector3d start_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d end_ = Eigen::Vector3d::Zero();
  math::Twist end_velocity_;
  std::vector<Share> shares_;
  double pressing_ = 0;                                 // N, sum of the normal forces' magnitudes
  double stored_ = 0;                                   // J, of penetration
  Eigen::Vector3d normal_ = Eigen::Vector3d::Zero();    // N, on the object
  Eigen::Vector3d traction_ = Eigen::Vector3d::Zero();  // N, friction on the object
  double shear_ = 0;                                    // N/m, of its spring
  FingertipTouch touch_;
  math::Wrench mean_wrench_;
};

}  // namespace palpate::object
