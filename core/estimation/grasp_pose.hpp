#pragma once

#include "core/elasticity/deformation_model.hpp"

namespace palpate::estimation {

/// Pose of G in O that the nodes of a grasp stand for, held or not: the rigid motion that fits them
/// best in the least-squares sense. Fewer than three nodes: their displacement only.
math::Pose grasp_pose(const elasticity::DeformationModel& model, int grasp) noexcept;

}  // namespace palpate::estimation
