#pragma once

#include <Eigen/Core>
#include <vector>

namespace palpate::mesh {

/// Diagonal of the box round those points that are finite, m.
double diagonal(const Eigen::Matrix3Xd& points);

/// For each point the first one that it is within `tolerance` of, itself where there is none. What
/// is not finite is near to nothing.
std::vector<int> near_nodes(const Eigen::Matrix3Xd& points, double tolerance);

}  // namespace palpate::mesh
