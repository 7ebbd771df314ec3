#pragma once

#include <vector>

#include "sim/object/hexahedral_grid.hpp"

namespace palpate::object {

/// Cuts [0, length] into `count` elements, the shorter the nearer they are to the `planes`, where
/// the strain is singular: about `growth` times as long as their neighbours on the side of the
/// plane. Planes within the side are cuts. With growth 1 all are equal and planes do not count.
/// Throws std::invalid_argument unless length > 0, growth >= 1 and there is an element a section.
std::vector<double> graded_borders(double length, int count, std::vector<double> planes,
                                   double growth);

/// Coordinates along `axis` where a hold of the box [origin, origin + size] begins: faces of the
/// hold within it, and the plane of a flat hold; m from the origin.
std::vector<double> planes_of(const Box& hold, const Eigen::Vector3d& origin,
                              const Eigen::Vector3d& size, int axis);

}  // namespace palpate::object
