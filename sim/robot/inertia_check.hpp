#pragma once

#include <string>
#include <vector>

namespace urdf {
class ModelInterface;
}

namespace palpate::robot {

/// Most that a body which a joint moves may outweigh the lightest of its neighbours across moving
/// joints before steps of a millisecond are at risk: the light one is thrown about by the rounding
/// of the heavy one's forces.
inline constexpr double kMostMassRatio = 1000;

/// What of a robot's masses and inertias would make its simulation unstable or is no body's at all,
/// a sentence each, naming the links: bodies (links joined by fixed joints together) of very unlike
/// mass at a joint, bodies beyond a joint that weigh nothing, moments that no mass could have.
std::vector<std::string> remarks_on_inertia(const urdf::ModelInterface& model);

}  // namespace palpate::robot
