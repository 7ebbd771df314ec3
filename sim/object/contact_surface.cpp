#include "sim/object/contact_surface.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "sim/object/hexahedral_grid.hpp"

namespace palpate::object {

ContactSurface::ContactSurface(const HexahedralGrid& grid, double spacing, Rule rule)
    : faces_(grid.faces()) {
  if (!(spacing > 0)) throw std::invalid_argument("plant: surface samples need a spacing > 0");
  std::array<int, 3> first{};  // side of each axis
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<double>& borders = grid.borders()[axis];
    first[axis] = static_cast<int>(sides_.size());
    for (std::size_t i = 0; i + 1 < borders.size(); ++i)
      sides_.emplace_back(borders[i + 1] - borders[i], spacing, rule);
  }
  for (int f = 0; f < face_count(); ++f) {
    const std::array<int, 3> cell = grid.cell(grid.face_element(f));
    const int u = (grid.face_axis(f) + 1) % 3, v = (grid.face_axis(f) + 2) % 3;
    face_sides_.push_back({first[u] + cell[u], first[v] + cell[v]});
    first_samples_.push_back(sample_count_);
    sample_count_ += static_cast<int>(sides_[face_sides_.back()[0]].samples.size() *
                                      sides_[face_sides_.back()[1]].samples.size());
  }
}

ContactSurface::Side::Side(double length, double spacing, Rule rule) {
  const int count = std::max(1, static_cast<int>(std::ceil(length / (kCell * spacing))));
  apart = length / (kCell * count);
  // Gauss points of two neighbouring rectangles lie 1 / sqrt(3) instead of 1 / 2 of their length
  // away from the border between them.
  const double away = rule == Rule::kGauss ? 2 / std::sqrt(3.0) - 1 : 0;
  for (int i = 0; i < kCell * count; ++i) {
    const double shift = i % 2 == 0 ? -away : away;
    samples.push_back(QuadraticShape((2.0 * i + 1 + shift) / (kCell * count) - 1).value);
  }
  for (int i = 0; i < count; ++i) cells.push_back(QuadraticShape((2.0 * i + 1) / count - 1).value);
}

Box ContactSurface::bounds(const Corners& corners) noexcept {
  const Eigen::Vector3d lower = corners.rowwise().minCoeff();
  const Eigen::Vector3d upper = corners.rowwise().maxCoeff();
  // Between its nodes the surface may bulge out of their bounding box by at most this much.
  const Eigen::Vector3d bulge = 0.5 * (kWeightSum - 1) * (upper - lower);
  return {lower - bulge, upper + bulge};
}

}  // namespace palpate::object
