#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <variant>
#include <vector>

#include "core/math/rigid.hpp"
#include "sim/object/contact_surface.hpp"

namespace palpate::object {

/// Half space below a plane: a table or a wall. In O.
struct HalfSpace {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    // of the plane, m
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // out of the obstacle, of any length

  /// Signed distance of `p` from the surface, m, negative inside; unit normal there. The vector
  /// must have unit length.
  double distance(const Eigen::Vector3d& p) const noexcept { return normal.dot(p - point); }
  Eigen::Vector3d outward(const Eigen::Vector3d& /*p*/) const noexcept { return normal; }
};

/// Solid cylinder. In O.
struct Cylinder {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();          // middle of its axis, m
  Eigen::Vector3d axis = Eigen::Vector3d::UnitY();          // of any length
  double radius = 0.03;                                     // m
  double length = std::numeric_limits<double>::infinity();  // m

  /// As for the half space; outside, beyond the rim of an end, a lower bound of the distance.
  double distance(const Eigen::Vector3d& p) const noexcept;
  Eigen::Vector3d outward(const Eigen::Vector3d& p) const noexcept;
};

/// A rigid obstacle at rest in O.
struct ObstacleOptions {
  std::variant<HalfSpace, Cylinder> shape;
  double friction = 0.5;  // Coulomb
  double stiffness = 0;   // Pa/m, pressure per penetration; 0: kObstacleStiffness * E
  double damping = 0;     // s/m, growth of the pressure with the speed of approach
};

/// 1/m, stiffness of an obstacle relative to Young's modulus of the object, unless given: a
/// pressure of 0.2 E penetrates by 0.1 mm.
inline constexpr double kObstacleStiffness = 2000;

/// Ground truth of the contact with an obstacle, in O.
struct ObstacleTouch {
  bool touching = false;
  math::Wrench wrench;  // of the obstacle on the object, about the origin of O
  double area = 0;      // m^2, rest area of the surface under pressure
  double depth = 0;     // m, largest penetration
  double slipping = 0;  // m^2, rest area that slips
};

/// A rigid obstacle in contact with the deformed surface of the object.
///
/// Every surface sample at a depth d inside the obstacle bears the pressure
///   p = stiffness * d * max(0, 1 + damping * dd/dt)
/// along the obstacle's normal (Hunt and Crossley, J. Appl. Mech. 42 (1975) 440); without damping
/// it is the gradient of the energy sum A stiffness d^2 / 2. Friction is a tangential spring per
/// sample of half that stiffness, loaded by the material's motion, whose traction is limited to
/// friction * p (regularised Coulomb). A sample that comes into contact is unloaded, one that loses
/// contact forgets its traction, so that neither adds energy. Force and torque balance to rounding.
class ObstacleContact {
 public:
  /// Throws std::invalid_argument if a value is out of range; the stiffness must be given.
  ObstacleContact(const ObstacleOptions& options, const HexahedralGrid& grid);

  /// Upper bound, N/m, on the row sums of the stiffness that it adds to each node if the whole
  /// surface touches it without damping.
  Eigen::VectorXd greatest_stiffness(const Eigen::Matrix3Xd& positions) const;

  /// Adds the nodal forces, `h` s after the last call, and to `stiffness` (N/m) an upper bound on
  /// the row sums of the stiffness that it adds, or may add before the next step; damping counts as
  /// the stiffness that limits the step as much. `velocities` are mean values over those h s.
  void add_forces(const Eigen::Matrix3Xd& positions, const Eigen::Matrix3Xd& velocities, double h,
                  Eigen::Matrix3Xd& forces, Eigen::VectorXd& stiffness) noexcept;

  const ObstacleTouch& touch() const { return touch_; }

  /// Wrench on the object about the origin of O, in O, averaged over the last step of the plant,
  /// which begins the average and adds its substeps with weights that sum to 1.
  math::Wrench mean_wrench() const { return math::Wrench::from(mean_); }
  void begin_mean() noexcept { mean_.setZero(); }
  void add_to_mean(double weight) noexcept { mean_ += weight * touch_.wrench.vector(); }

  /// Energy of penetration and of the tangential springs, J.
  double energy() const { return energy_; }
  double stiffness() const { return options_.stiffness; }

 private:
  template <class Shape>
  void press(const Shape& shape, const Eigen::Matrix3Xd& positions,
             const Eigen::Matrix3Xd& velocities, double h, Eigen::Matrix3Xd& forces,
             Eigen::VectorXd& stiffness) noexcept;
  Eigen::Vector3d friction_at(const SurfaceSample& sample, double pressure,
                              const Eigen::Vector3d& normal, const Eigen::Vector3d& velocity,
                              double h) noexcept;

  ObstacleOptions options_;
  ContactSurface surface_;
  double shear_stiffness_;             // Pa/m
  Eigen::Matrix3Xd tractions_;         // Pa, on the object, by sample
  std::vector<std::int64_t> pressed_;  // number of the last call with contact, by sample
  std::int64_t call_ = 0;
  ObstacleTouch touch_;
  math::Vector6d mean_ = math::Vector6d::Zero();
  double energy_ = 0;
};

}  // namespace palpate::object
