#pragma once

#include <Eigen/Core>
#include <memory>

#include "core/math/rigid.hpp"

namespace palpate::robot {

/// Where a probe touches the box, in O.
struct ProbeContact {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // N, of the box on the probe
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  // m, mean of the points, weighted by force
  double depth = 0;                                 // m, greatest penetration
};

struct SoftBoxOptions {
  Eigen::Vector3d size{0.08, 0.08, 0.08};  // m, from the origin of O
  Eigen::Vector3i vertices{5, 5, 5};       // along each edge, 3 at least; 230 in all at most
  double mass = 0.02;                      // kg, spread over the vertices
  double vertex_stiffness = 50;            // N/m, of each vertex to its rest place in the core
  double edge_stiffness = 20;  // N/m, along each edge, of the difference of displacements
  double damping = 0.2;        // N s/m, of each vertex
  bool on_floor = true;        // else its core is fixed
  double friction = 0.6;
  Eigen::Vector3d gravity_O{0, 0, -9.81};  // m/s^2
};

/// DART's soft body (Jain and Liu 2011) as a plant: a box whose skin of point masses hangs on
/// springs about a rigid core. The core stands free on the plane z = 0 of O, or is fixed. It dents
/// where it is touched and comes back, but does not bend or stretch as a whole: that its core
/// cannot do. Probes, fingertips or plates, move as prescribed, whatever the box does. Contact is
/// found where surfaces cross, so that a probe narrower than the distance of vertices meets one or
/// two of them, and one that enters by more than a triangle in a step is lost. All quantities are
/// in O.
class DartSoftBody {
 public:
  /// Throws std::invalid_argument.
  explicit DartSoftBody(const SoftBoxOptions& options);
  ~DartSoftBody();

  /// Before the first step; returns the probe's number. `position` of its centre, m.
  int add_sphere(double radius, const Eigen::Vector3d& position);
  int add_plate(const Eigen::Vector3d& size, const Eigen::Vector3d& position);

  /// Velocity of a probe's centre from now on, m/s.
  void move(int probe, const Eigen::Vector3d& velocity);

  /// Force on a vertex from now on, N.
  void pull(int vertex, const Eigen::Vector3d& force);

  void step(double dt);

  /// What DART itself uses for it, in a line.
  std::string effective_options() const;

  int vertex_count() const;
  const Eigen::Matrix3Xd& positions() const;          // m
  const Eigen::Matrix3Xi& surface_triangles() const;  // outward
  math::Pose core() const;                            // of the box's centre
  Eigen::Vector3d probe_position(int probe) const;
  /// Mean contact force of the box on a probe over the last step, N.
  Eigen::Vector3d probe_force(int probe) const;
  const ProbeContact& probe_contact(int probe) const;
  /// The same of all that touched the floor.
  Eigen::Vector3d floor_force() const;
  int contact_count() const;  // in the last step

 private:
  struct Dynamics;
  std::unique_ptr<Dynamics> dynamics_;
};

}  // namespace palpate::robot
