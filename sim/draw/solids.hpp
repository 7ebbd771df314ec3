#pragma once

#include <Eigen/Core>

namespace palpate::draw {

/// Closed triangle mesh. points: 3 x n, m; triangles: 3 x m, oriented outward by the right-hand
/// rule.
struct TriangleMesh {
  Eigen::Matrix3Xd points;
  Eigen::Matrix3Xi triangles;
};

/// Box of full side lengths `size`, centred at the origin.
TriangleMesh make_box(const Eigen::Vector3d& size);

/// Solid of revolution about z: circles (radius, z) in ascending z, closed to the axis at both
/// ends.
TriangleMesh make_revolution(const Eigen::Matrix2Xd& profile, int segments);

/// Cylinder along z, centred at the origin.
TriangleMesh make_cylinder(double radius, double length);

/// Sphere about the origin.
TriangleMesh make_sphere(double radius);

/// Arrow from the origin along z; the head takes at most half of the length.
TriangleMesh make_arrow(double length, double shaft_radius);

/// Unit normals at the corners of each triangle, 3 x 3m: the area-weighted mean over the triangles
/// that share the vertex and whose normals lie within `crease` radians; 0 gives flat shading.
Eigen::Matrix3Xd corner_normals(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xi& triangles,
                                double crease);

}  // namespace palpate::draw
