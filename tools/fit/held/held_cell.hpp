#pragma once

#include <string>
#include <vector>

#include "core/sensing/payload.hpp"
#include "rt/registry/object.hpp"

namespace palpate::fit {

/// What a configuration of palpated says of an object in one hand: where things are, the mesh, its
/// grasp and what holds it, and what the hand weighs behind the force-torque sensor.
struct HeldCell {
  registry::Frames frames;
  registry::Object object;
  sensing::PayloadParameters hand;  // none where the configuration names none
  int polarity = 1;                 // -1: the sensor tells what the load exerts on it
};

/// Throws config::Error: also where the object is in two hands, or in none.
HeldCell read_held_cell(const std::string& configuration,
                        const std::vector<std::string>& overrides = {});

}  // namespace palpate::fit
