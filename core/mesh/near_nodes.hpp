#pragma once

#include <Eigen/Core>
#include <vector>

namespace palpate::mesh {

/// Diagonal of the bounding box of the finite points, m.
double diagonal(const Eigen::Matrix3Xd& points);

/// For each point the first one within `tolerance` of it, or itself. Non-finite points have no
/// neighbours.
std::vector<int> near_nodes(const Eigen::Matrix3Xd& points, double tolerance);

/// Points that lie within `tolerance` of an earlier one, ascending.
std::vector<int> duplicates(const Eigen::Matrix3Xd& points, double tolerance);

}  // namespace palpate::mesh
