#pragma once

#include <vector>

#include "core/elasticity/body.hpp"

namespace palpate::bench {

/// Approximation of a round surface by a mesh of tetrahedra.
enum class Sides {
  kStraight,  // corners on the surface, the volume slightly small
  kInflated,  // the same, expanded to the correct volume
  kCurved,    // midside nodes on the surface too (quadratic elements only)
};

struct RoundBody {
  elasticity::Body body;                // clamped at one end
  Eigen::Matrix3Xd loads;               // N, a dead uniform traction on the other end
  std::vector<Eigen::Vector3d> probes;  // rest points that are corners of every mesh with its
                                        // corners on the surface
};

/// A cylinder along x, 0.20 m long, of radius 0.025 m, bent by 0.5 N: rings of triangles around the
/// axis, ring k of 6 k nodes, in layers. `layers`: a multiple of 4.
RoundBody make_cylinder(int rings, int layers, mesh::ElementOrder order, Sides sides);

/// An ellipsoid with half axes 0.05, 0.03, 0.03 m, compressed and sheared: an icosahedron about its
/// centre, each of the 20 tetrahedra divided into m^3 and projected to the surface. Clamp and load
/// are the five faces around its ends on the x axis.
RoundBody make_ellipsoid(int m, mesh::ElementOrder order, Sides sides);

}  // namespace palpate::bench
