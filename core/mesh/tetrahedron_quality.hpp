#pragma once

#include "core/mesh/tetrahedral_mesh.hpp"

namespace palpate::mesh {

/// How good a tetrahedron is for finite elements. Of one that is flat, or whose numbers are not
/// finite, the ratios are 0 and the stiffness is infinite; of one inside out they are those of its
/// mirror image.
struct TetrahedronQuality {
  double volume = 0;           // m^3, negative where it is inside out
  double shortest_edge = 0;    // m
  double longest_edge = 0;     // m
  double smallest_angle = 0;   // rad, dihedral; 1.231 in a regular tetrahedron
  double largest_angle = 0;    // rad
  double radius_ratio = 0;     // 3 r_in / r_out, 1 for a regular one
  double scaled_jacobian = 0;  // 6 sqrt(2) V by the largest product of three edges at a corner
  /// Largest eigenvalue of its stiffness (Poisson's ratio 0.3) by that of a regular tetrahedron of
  /// the same volume: what it adds to the condition of the whole system (Shewchuk 2002).
  double stiffness = 0;
};

TetrahedronQuality measure(const TetrahedralMesh& mesh, int t);

}  // namespace palpate::mesh
