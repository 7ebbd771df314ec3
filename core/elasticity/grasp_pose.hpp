#pragma once

#include "core/elasticity/body.hpp"

namespace palpate::elasticity {

/// Pose of G in O given by the node positions of a grasp, held or not: the least-squares rigid
/// motion. With fewer than three nodes: displacement only.
math::Pose grasp_pose(const Body& body, int grasp, const Eigen::Matrix3Xd& positions) noexcept;

}  // namespace palpate::elasticity
