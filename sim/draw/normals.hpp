#pragma once

#include <Eigen/Core>

namespace palpate::draw {

/// Unit normals at the corners of each triangle, 3 x 3m: the area-weighted mean over the triangles
/// that share the vertex and whose normals lie within `crease` radians; 0 gives flat shading.
Eigen::Matrix3Xd corner_normals(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xi& triangles,
                                double crease);

}  // namespace palpate::draw
