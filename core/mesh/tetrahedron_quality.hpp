#pragma once

#include "core/mesh/tetrahedral_mesh.hpp"

namespace palpate::mesh {

/// Quality of a tetrahedron for finite elements. For a flat one, or one with non-finite
/// coordinates, the ratios are 0 and the stiffness is infinite; for an inverted one they are those
/// of its mirror image.
struct TetrahedronQuality {
  double volume = 0;          // m^3, negative if inverted
  double longest_edge = 0;    // m
  double smallest_angle = 0;  // rad, dihedral; 1.231 for a regular tetrahedron
  double largest_angle = 0;   // rad
  double radius_ratio = 0;    // 3 r_in / r_out, 1 for a regular tetrahedron
  /// 6 sqrt(2) V divided by the largest product of three edges at a corner
  double scaled_jacobian = 0;
  /// Largest eigenvalue of its stiffness (Poisson's ratio 0.3) relative to that of a regular
  /// tetrahedron of the same volume: its influence on the condition number of the system (Shewchuk
  /// 2002).
  double stiffness = 0;
};

TetrahedronQuality measure(const TetrahedralMesh& mesh, int t);

}  // namespace palpate::mesh
