#pragma once

#include "core/elasticity/body.hpp"

namespace palpate::estimation {

/// Unmodelled compliance of a grasp. The model moves all nodes of the grasp patch as one rigid
/// body, on a mesh that is coarse where strain concentrates around the patch. In a real hand only
/// the surface of the patch adheres to the pads, and the material between the pads deforms slightly
/// into the hand. Both effects make the model too stiff near the grasp and bias the whole shape.
///
/// Returns the compliance, (m, rad) per (N, N m) at the origin of G, in G, pads included, by which
/// the model's patch must move relative to the hand so that its nodes match, in the least-squares
/// sense, those of a mesh with edges half as long, held by springs on the surface of the patch
/// only. Valid for small motions about the rest shape and extrapolated with the wrench to large
/// ones. It is not a spring and not symmetric.
///
/// `pads`: pad_compliance() of the grasp. Other grasps remain held. Returns `pads` unchanged if it
/// is zero, if elements are linear (whose errors lie elsewhere), if the mesh has more than 2000
/// nodes, or if only this grasp holds the object. Takes 0.03 s for 189 nodes, 0.25 s for 363.
/// Throws std::invalid_argument for a body with inverted elements.
math::Matrix6d grasp_compliance(const elasticity::Body& body, std::size_t grasp,
                                const math::Matrix6d& pads);

}  // namespace palpate::estimation
