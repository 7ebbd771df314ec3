#pragma once

#include <array>
#include <string>
#include <vector>

#include "sim/object/hexahedral_grid.hpp"

namespace palpate::object {

/// Divides [0, length] into `count` elements, which are shorter near the `planes`, where the strain
/// is singular: each is about `growth` times as long as its neighbour on the side of the plane.
/// Planes within the side are element borders. With growth 1 all are equal and planes are ignored.
/// Throws std::invalid_argument unless length > 0, growth >= 1 and there is at least one element
/// per section.
std::vector<double> graded_borders(double length, int count, std::vector<double> planes,
                                   double growth);

/// Coordinates along `axis` where a grasp or clamp of the box [origin, origin + size] begins: faces
/// of its box within the object, and the plane of a flat one; m from the origin.
std::vector<double> planes_of(const Box& hold, const Eigen::Vector3d& origin,
                              const Eigen::Vector3d& size, int axis);

/// A sentence for each face of a grasp or clamp within the object that lies on none of the element
/// borders (m from `origin`) nor, with `midnodes`, halfway between two: how far it holds instead.
std::vector<std::string> misfits(const Box& hold, const Eigen::Vector3d& origin,
                                 const std::array<std::vector<double>, 3>& borders, bool midnodes);

}  // namespace palpate::object
