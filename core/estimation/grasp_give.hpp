#pragma once

#include "core/elasticity/body.hpp"

namespace palpate::estimation {

/// What a grasp gives way by that the model does not know of. The model moves all nodes of the
/// patch as one rigid piece, on a mesh that is coarse where strain gathers about it; in a hand only
/// the surface of the patch hangs on the pads, and what lies between them bends a little way into
/// the hand. Both make the model too stiff beside the grasp, and its shape is off all along.
///
/// Returned is the compliance, (m, rad) by (N, N m) at the origin of G, in G, pads included, by
/// which the model's patch is to move in the hand so that its nodes are, in the sense of least
/// squares, where a mesh with edges half as long has them, with springs on the surface of the patch
/// and nothing held within. It holds for small motions from rest and goes with the wrench to large
/// ones; it is no spring, and not symmetric.
///
/// `pads`: pad_compliance() of the grasp. Other grasps are held meanwhile. `pads` as it is where
/// that is zero, where elements are linear, whose errors lie elsewhere, where the mesh has more
/// than 2000 nodes, or where nothing but this grasp holds the object. Takes 0.03 s for 189 nodes,
/// 0.25 s for 363. Throws std::invalid_argument for a body whose elements are inside out.
math::Matrix6d grasp_give(const elasticity::Body& body, std::size_t grasp,
                          const math::Matrix6d& pads);

}  // namespace palpate::estimation
