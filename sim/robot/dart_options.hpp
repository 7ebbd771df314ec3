#pragma once

#include <string>

namespace dart::simulation {
class World;
}

namespace palpate::robot {

/// The settings that DART itself reports for a world, in one line: step, gravity, integration,
/// collision detector and its contact limit, solver, error reduction of rigid and soft contacts.
/// Read back from DART, so that an option it has ignored is visible.
std::string effective_options(const dart::simulation::World& world);

}  // namespace palpate::robot
