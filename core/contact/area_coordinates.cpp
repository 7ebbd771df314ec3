#include "core/contact/area_coordinates.hpp"

#include <algorithm>

#include "core/math/option_check.hpp"

namespace palpate::contact {

AreaCoordinates::AreaCoordinates(const mesh::ElementMesh& mesh, const mesh::Surface& surface,
                                 const Options& options)
    : collision_distance_(options.collision_distance),
      rest_positions_(mesh.nodes),
      triangles_(surface.triangles) {
  math::check_positive(options.collision_distance, "collision_distance");
  math::check_option(triangles_.cols() > 0, "surface", triangles_.cols(), "at least one triangle");
  fixed_.reserve(options.fixed_rest_points.size());
  for (const Eigen::Vector3d& point : options.fixed_rest_points)
    fixed_.push_back(mesh::closest_point_on_surface(point, triangles_, rest_positions_));
}

int AreaCoordinates::max_nodes() const noexcept {
  return 3 * std::max(1, static_cast<int>(fixed_.size()));
}

bool AreaCoordinates::push(const mesh::SurfacePoint& point, const Eigen::Vector3d& force,
                           ContactLoads& out) const noexcept {
  for (int i = 0; i < 3; ++i)
    if (!out.push(triangles_(i, point.triangle), point.weights[i] * force)) return false;
  return true;
}

void AreaCoordinates::distribute(const sensing::Contact& contact, const Eigen::Matrix3Xd& positions,
                                 ContactLoads& out) noexcept {
  out.source = contact.source;
  out.location = contact.location;
  out.accepted = false;
  out.loads.clear();
  if (!contact.wrench.force.allFinite() || !contact.location.allFinite()) return;

  bool fits = true;
  if (!fixed_.empty()) {
    const Eigen::Vector3d share = contact.wrench.force / static_cast<double>(fixed_.size());
    for (const mesh::SurfacePoint& point : fixed_) fits = fits && push(point, share, out);
  } else {
    const bool at_rest_point = contact.source == sensing::Source::kManual;
    const mesh::SurfacePoint point = mesh::closest_point_on_surface(
        contact.location, triangles_, at_rest_point ? rest_positions_ : positions);
    if (point.triangle < 0 || !(point.distance <= collision_distance_)) return;
    fits = push(point, contact.wrench.force, out);
  }
  out.accepted = fits;
  if (!fits) out.loads.clear();
}

}  // namespace palpate::contact
