#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/object/hexahedral_grid.hpp"
#include "sim/object/neo_hookean_solid.hpp"

namespace palpate::object {

/// Longest stable step, s, of the explicit integration of a solid at rest: nodal masses (kg), an
/// isotropic spring to the environment per node (N/m), fixed nodes. By power iteration; viscosity
/// shortens it because velocities lag by half a step (Belytschko, Liu, Moran: Nonlinear Finite
/// Elements, sec. 6.2). Takes the solid by value because it modifies its history.
double critical_step(const HexahedralGrid& grid, NeoHookeanSolid solid,
                     const Eigen::VectorXd& masses, const Eigen::VectorXd& springs,
                     const std::vector<int>& held);

}  // namespace palpate::object
