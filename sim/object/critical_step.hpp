#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/object/hexahedral_grid.hpp"
#include "sim/object/neo_hookean_solid.hpp"

namespace palpate::object {

/// Longest stable step, s, of the explicit integration of a solid at rest: nodal masses (kg), an
/// isotropic spring to the outside per node (N/m), nodes held still. By power iteration; viscosity
/// shortens it as velocities lag by half a step (Belytschko, Liu, Moran: Nonlinear Finite Elements,
/// sec. 6.2). Takes a copy of the solid, whose memory it disturbs.
double critical_step(const HexahedralGrid& grid, NeoHookeanSolid solid,
                     const Eigen::VectorXd& masses, const Eigen::VectorXd& springs,
                     const std::vector<int>& held);

}  // namespace palpate::object
