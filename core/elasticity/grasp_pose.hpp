#pragma once

#include "core/elasticity/body.hpp"

namespace palpate::elasticity {

/// Pose of G in O that the nodes of a grasp stand for, held or not: the rigid motion that fits them
/// best in the least-squares sense. Fewer than three nodes: their displacement only.
math::Pose grasp_pose(const Body& body, int grasp, const Eigen::Matrix3Xd& positions) noexcept;

}  // namespace palpate::elasticity
