#pragma once

#include "core/mesh/mesh_reader.hpp"

namespace palpate::mesh {

/// How a mesh follows a round surface.
enum class RoundSides {
  kFull,    // straight sides, drawn out evenly until the volume is that of the round body
  kCurved,  // corners and the middles of edges on the surface, for 10-node elements
};

/// A cylinder along x from the origin: rings of triangles round the axis, ring k of 6 k nodes,
/// layer upon layer, three tetrahedra a prism. Groups: the triangles of its faces `x_min`, `x_max`
/// and `side`, the tetrahedra `body`. Throws std::invalid_argument where a number is not positive.
MeshWithGroups make_cylinder(double radius, double length, int rings, int layers, RoundSides sides);

/// An ellipsoid about the origin: an icosahedron, each of the 20 tetrahedra to its centre cut into
/// `cells`^3 and drawn out to the surface. Groups: the triangles `surface`, the tetrahedra `body`.
/// Throws std::invalid_argument where a number is not positive.
MeshWithGroups make_ellipsoid(const Eigen::Vector3d& half_axes, int cells, RoundSides sides);

}  // namespace palpate::mesh
