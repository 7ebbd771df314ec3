#pragma once

#include <string>

namespace dart::simulation {
class World;
}

namespace palpate::robot {

/// What DART itself says that it uses for a world, in a line: step, gravity, integration,
/// collision detector and how many contacts it takes, solver, error reduction of rigid and soft
/// contacts. Read back from DART, so that an option it has ignored shows.
std::string effective_options(const dart::simulation::World& world);

}  // namespace palpate::robot
