#pragma once

#include <string>
#include <vector>

namespace urdf {
class ModelInterface;
}

namespace palpate::robot {

/// Largest mass ratio between a body moved by a joint and its lightest neighbour across moving
/// joints; above it, steps of one millisecond are at risk: rounding errors of the heavy body's
/// forces throw the light one about.
inline constexpr double kMostMassRatio = 1000;

/// Properties of a robot's masses and inertias that would make its simulation unstable or are not
/// physical, one sentence each, naming the links: very different masses of bodies (links joined by
/// fixed joints) at a joint, bodies beyond a joint without mass, moments of inertia that no mass
/// distribution could have.
std::vector<std::string> remarks_on_inertia(const urdf::ModelInterface& model);

}  // namespace palpate::robot
