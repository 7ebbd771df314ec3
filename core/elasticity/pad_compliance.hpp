#pragma once

#include "core/elasticity/body.hpp"
#include "core/mesh/surface.hpp"

namespace palpate::elasticity {

/// Compliance of a hand's pads with a total stiffness of `stiffness` N/m, distributed uniformly
/// over the surface of the grasp's patch: the small motion (m, rad) of the object relative to the
/// hand is the negative of this matrix times the wrench of the hand on it, all at the origin of G,
/// in G. Zero if the stiffness is infinite. Throws std::invalid_argument if it is not positive or
/// the patch has too little surface to resist every motion.
math::Matrix6d pad_compliance(const Body& body, const GraspRegion& grasp,
                              const mesh::Surface& surface, double stiffness);

}  // namespace palpate::elasticity
