#pragma once

#include "core/elasticity/body.hpp"
#include "core/mesh/surface.hpp"

namespace palpate::elasticity {

/// How the object gives way in a hand whose pads, of `stiffness` N/m all together, are spread
/// evenly over the surface of the grasp's patch: its small motion (m, rad) relative to the hand is
/// minus this times the wrench of the hand on it, all at the origin of G, in G. Zero where the
/// stiffness is infinite. Throws std::invalid_argument where it is not positive or the patch has
/// too little surface to resist every motion.
math::Matrix6d pad_compliance(const Body& body, const GraspRegion& grasp,
                              const mesh::Surface& surface, double stiffness);

}  // namespace palpate::elasticity
