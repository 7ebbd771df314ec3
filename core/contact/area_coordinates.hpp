#pragma once

#include <vector>

#include "core/contact/force_transformer.hpp"
#include "core/contact/surface_search.hpp"

namespace palpate::contact {

/// The thesis' force transformer (4.2): a force on the three corners of the surface triangle that
/// it touches, shared by areal coordinates. Nearest triangle of the surface rather than the nearest
/// vertices of the mesh; coordinates of the point projected on it, so that they never leave [0, 1]
/// and reproduce every affine function. The contact's torque is dropped, as published: use
/// WrenchPatch where it matters. On quadratic meshes the corner nodes carry the load.
class AreaCoordinates : public ForceTransformer {
 public:
  struct Options {
    double collision_distance = 0.01;  // m: contacts farther from the surface are refused
    /// Rest points (m, in O) that always carry the load, in equal parts, wherever the contact is
    /// said to be: a grasp that does not slide. Empty: the load follows the contact.
    std::vector<Eigen::Vector3d> fixed_rest_points;
  };

  /// Throws std::invalid_argument naming the option that is wrong, or for a mesh without surface.
  AreaCoordinates(const mesh::ElementMesh& mesh, const mesh::Surface& surface,
                  const Options& options);

  int max_nodes() const noexcept override;
  void distribute(const sensing::Contact& contact, const Eigen::Matrix3Xd& positions,
                  ContactLoads& out) noexcept override;

 private:
  bool push(const SurfacePoint& point, const Eigen::Vector3d& force,
            ContactLoads& out) const noexcept;

  double collision_distance_;
  Eigen::Matrix3Xd rest_positions_;
  Eigen::Matrix3Xi triangles_;
  std::vector<SurfacePoint> fixed_;
};

}  // namespace palpate::contact
