#pragma once

#include <Eigen/Core>
#include <memory>

#include "core/math/rigid.hpp"

namespace palpate::robot {

/// Contact of a probe with the box, in O.
struct ProbeContact {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // N, from the box on the probe
  Eigen::Vector3d point =
      Eigen::Vector3d::Zero();  // m, mean of the contact points, weighted by force
  double depth = 0;             // m, largest penetration
};

struct SoftBoxOptions {
  Eigen::Vector3d size{0.08, 0.08, 0.08};  // m, from the origin of O
  Eigen::Vector3i vertices{5, 5, 5};  // vertices along each edge, at least 3; at most 230 in all
  double mass = 0.02;                 // kg, spread over the vertices
  double vertex_stiffness = 50;       // N/m, from each vertex to its rest position in the core
  double edge_stiffness = 20;         // N/m, along each edge, on the difference of displacements
  double damping = 0.2;               // N s/m, of each vertex
  double friction = 0.6;
  Eigen::Vector3d gravity_O{0, 0, -9.81};  // m/s^2
};

/// DART's soft body (Jain and Liu 2011) as a plant: a box whose skin of point masses is attached by
/// springs to a rigid, fixed core. The body dents locally and recovers, but does not bend or
/// stretch globally. Probes, fingertips or plates, follow prescribed motions regardless of the box.
/// Contact is detected where surfaces intersect, so that a probe narrower than the vertex spacing
/// meets only one or two vertices, and one that penetrates by more than a triangle in one step is
/// lost. All quantities are in O.
class DartSoftBody {
 public:
  /// Throws std::invalid_argument.
  explicit DartSoftBody(const SoftBoxOptions& options);
  ~DartSoftBody();

  /// Adds a probe before the first step; returns its index. `position` of its centre, m.
  int add_sphere(double radius, const Eigen::Vector3d& position);
  int add_plate(const Eigen::Vector3d& size, const Eigen::Vector3d& position);

  /// Sets the velocity of a probe's centre until replaced, m/s.
  void move(int probe, const Eigen::Vector3d& velocity);

  /// Sets the force on a vertex until replaced, N.
  void pull(int vertex, const Eigen::Vector3d& force);

  void step(double dt);

  /// The settings that DART itself reports for it, in one line.
  std::string effective_options() const;

  int vertex_count() const;
  const Eigen::Matrix3Xd& positions() const;          // m
  const Eigen::Matrix3Xi& surface_triangles() const;  // outward
  math::Pose core() const;                            // of the box's centre
  Eigen::Vector3d probe_position(int probe) const;
  /// Mean over the last step. Throws std::out_of_range.
  const ProbeContact& probe_contact(int probe) const;
  int contact_count() const;  // in the last step

 private:
  struct Dynamics;
  std::unique_ptr<Dynamics> dynamics_;
};

}  // namespace palpate::robot
