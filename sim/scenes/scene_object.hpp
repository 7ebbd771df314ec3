#pragma once

#include "rt/config/node.hpp"
#include "sim/scenes/scene.hpp"

namespace palpate::scenes {

/// {lower, upper}, m, in O. Throws config::Error.
object::Box read_box(const config::Node& node);

/// The key `object` of a scene: shape, material, what holds it, and its pose. Throws config::Error.
void read_object(const config::Node& node, Scene& scene);

}  // namespace palpate::scenes
