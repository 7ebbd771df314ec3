#include "sim/object/contact_surface.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "sim/object/quadratic_shape.hpp"

namespace palpate::object {

ContactSurface::ContactSurface(const HexahedralGrid& grid, double spacing) : faces_(grid.faces()) {
  if (!(spacing > 0)) throw std::invalid_argument("plant: surface samples need a spacing > 0");
  for (int f = 0; f < face_count(); ++f) axes_.push_back(grid.face_axis(f));
  std::array<double, 3> apart{};
  for (int axis = 0; axis < 3; ++axis) {
    const double length = grid.element_size()[axis];
    const int cells = std::max(1, static_cast<int>(std::ceil(length / (kCell * spacing))));
    apart[axis] = length / (kCell * cells);
    for (int i = 0; i < kCell * cells; ++i)
      samples_[axis].push_back(QuadraticShape((2.0 * i + 1) / (kCell * cells) - 1).value);
    for (int i = 0; i < cells; ++i)
      cells_[axis].push_back(QuadraticShape((2.0 * i + 1) / cells - 1).value);
  }
  for (int axis = 0; axis < 3; ++axis) {
    const double du = apart[(axis + 1) % 3], dv = apart[(axis + 2) % 3];
    sample_area_[axis] = du * dv;
    cell_radius_[axis] = 0.5 * kCell * std::hypot(du, dv);
  }
}

bool ContactSurface::may_touch(const Corners& corners, const Eigen::Vector3d& centre,
                               double reach) const noexcept {
  const Eigen::Vector3d lower = corners.rowwise().minCoeff();
  const Eigen::Vector3d upper = corners.rowwise().maxCoeff();
  // Between its nodes the surface may bulge out of their box by this much and no more.
  const Eigen::Vector3d bulge = 0.5 * (kWeightSum - 1) * (upper - lower);
  const Eigen::Vector3d nearest = centre.cwiseMax(lower - bulge).cwiseMin(upper + bulge);
  return (centre - nearest).squaredNorm() <= reach * reach;
}

}  // namespace palpate::object
