#include "sim/object/contact_surface.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "sim/object/hexahedral_grid.hpp"

namespace palpate::object {

ContactSurface::ContactSurface(const HexahedralGrid& grid, double spacing) : faces_(grid.faces()) {
  if (!(spacing > 0)) throw std::invalid_argument("plant: surface samples need a spacing > 0");
  std::array<int, 3> first{};  // side of each axis
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<double>& borders = grid.borders()[axis];
    first[axis] = static_cast<int>(sides_.size());
    for (std::size_t i = 0; i + 1 < borders.size(); ++i)
      sides_.emplace_back(borders[i + 1] - borders[i], spacing);
  }
  for (int f = 0; f < face_count(); ++f) {
    const std::array<int, 3> cell = grid.cell(grid.face_element(f));
    const int u = (grid.face_axis(f) + 1) % 3, v = (grid.face_axis(f) + 2) % 3;
    face_sides_.push_back({first[u] + cell[u], first[v] + cell[v]});
  }
}

ContactSurface::Side::Side(double length, double spacing) {
  const int count = std::max(1, static_cast<int>(std::ceil(length / (kCell * spacing))));
  apart = length / (kCell * count);
  for (int i = 0; i < kCell * count; ++i)
    samples.push_back(QuadraticShape((2.0 * i + 1) / (kCell * count) - 1).value);
  for (int i = 0; i < count; ++i) cells.push_back(QuadraticShape((2.0 * i + 1) / count - 1).value);
}

bool ContactSurface::may_touch(const Corners& corners, const Eigen::Vector3d& centre,
                               double reach) const noexcept {
  const Eigen::Vector3d lower = corners.rowwise().minCoeff();
  const Eigen::Vector3d upper = corners.rowwise().maxCoeff();
  // Between its nodes the surface may bulge out of their bounding box by at most this much.
  const Eigen::Vector3d bulge = 0.5 * (kWeightSum - 1) * (upper - lower);
  const Eigen::Vector3d nearest = centre.cwiseMax(lower - bulge).cwiseMin(upper + bulge);
  return (centre - nearest).squaredNorm() <= reach * reach;
}

}  // namespace palpate::object
