#pragma once

#include <vector>

#include "rt/config/node.hpp"
#include "sim/object/obstacle_contact.hpp"

namespace palpate::scenes {

/// The key `obstacles` of a scene: a list of {plane: {point, normal}} or {cylinder: {point, axis,
/// radius, length}}, each with friction, stiffness and damping; in O. They touch the object only:
/// arm and hand pass through them. Throws config::Error.
std::vector<object::ObstacleOptions> read_obstacles(const config::Node& scene);

}  // namespace palpate::scenes
