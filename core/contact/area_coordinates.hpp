#pragma once

#include <vector>

#include "core/contact/force_transformer.hpp"
#include "core/mesh/closest_point.hpp"

namespace palpate::contact {

/// Force transformer of Sanchez 2019 (section 4.2): distributes a force to the three corners of the
/// surface triangle in contact by areal coordinates. Differences from the thesis: the nearest
/// triangle of the surface is used rather than the nearest vertices of the mesh, and the
/// coordinates are those of the point projected onto it, so that they remain within [0, 1] and
/// reproduce every affine function. As published, the torque of the contact is dropped; use
/// WrenchPatch where it matters. On quadratic meshes the corner nodes carry the load.
class AreaCoordinates : public ForceTransformer {
 public:
  struct Options {
    double collision_distance = 0.01;  // m: contacts farther from the surface are rejected
    /// Rest points (m, in O) that always carry the load, in equal parts, whatever the reported
    /// location: a grasp without slip. Empty: the load follows the contact.
    std::vector<Eigen::Vector3d> fixed_rest_points;
  };

  /// Throws std::invalid_argument naming the invalid option, or for a mesh without a surface.
  AreaCoordinates(const mesh::ElementMesh& mesh, const mesh::Surface& surface,
                  const Options& options);

  int max_nodes() const noexcept override;
  void distribute(const sensing::Contact& contact, const Eigen::Matrix3Xd& positions,
                  ContactLoads& out) noexcept override;

 private:
  bool push(const mesh::SurfacePoint& point, const Eigen::Vector3d& force,
            ContactLoads& out) const noexcept;

  double collision_distance_;
  Eigen::Matrix3Xd rest_positions_;
  Eigen::Matrix3Xi triangles_;
  std::vector<mesh::SurfacePoint> fixed_;
};

}  // namespace palpate::contact
