#pragma once

#include <string>
#include <vector>

#include "core/sensing/payload.hpp"
#include "rt/registry/object.hpp"

namespace palpate::fit {

/// The part of palpated's configuration that concerns an object in one hand: poses, mesh, grasp and
/// support, and the load of the hand on the force-torque sensor.
struct HeldCell {
  registry::Frames frames;
  registry::Object object;
  sensing::PayloadParameters hand;  // empty if the configuration names none
  int polarity = 1;                 // -1: the sensor reports what the load exerts on it
};

/// Throws config::Error: also if the object is held by two hands, or by none.
HeldCell read_held_cell(const std::string& configuration,
                        const std::vector<std::string>& overrides = {});

}  // namespace palpate::fit
