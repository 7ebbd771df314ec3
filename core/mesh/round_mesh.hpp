#pragma once

#include <functional>
#include <string>

#include "core/mesh/mesh_reader.hpp"

namespace palpate::mesh {

/// Approximation of a curved surface by a mesh.
enum class RoundSides {
  kFull,    // straight sides, expanded uniformly until the volume is that of the round body
  kCurved,  // corners and edge midpoints on the surface, for 10-node elements
};

/// Cylinder along x from the origin: rings of triangles around the axis, ring k with 6 k nodes, in
/// layers of prisms, three tetrahedra each. Groups: the triangles of its faces `x_min`, `x_max` and
/// `side`, the tetrahedra `body`. Throws std::invalid_argument if a number is not positive.
MeshWithGroups make_cylinder(double radius, double length, int rings, int layers, RoundSides sides);

/// Ellipsoid about the origin: an icosahedron, each of whose 20 tetrahedra to its centre is divided
/// into `cells`^3 and projected onto the surface. Groups: the triangles `surface`, the tetrahedra
/// `body`. Throws std::invalid_argument if a number is not positive.
MeshWithGroups make_ellipsoid(const Eigen::Vector3d& half_axes, int cells, RoundSides sides);

/// Groups the boundary triangles of a mesh by the name that `name` returns for their corners
/// (columns, m); an empty name means no group. All tetrahedra become the group `body`.
void group_sides(MeshWithGroups& mesh,
                 const std::function<std::string(const Eigen::Matrix3d&)>& name);

}  // namespace palpate::mesh
