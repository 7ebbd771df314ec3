#pragma once

#include "sim/object/hyperelastic_plant.hpp"

namespace palpate::object {

/// N s.
inline Eigen::Vector3d linear_momentum(const HyperelasticPlant& plant) {
  return plant.velocities() * plant.nodal_masses();
}

/// N m s, about the origin of O.
inline Eigen::Vector3d angular_momentum(const HyperelasticPlant& plant) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (Eigen::Index n = 0; n < plant.nodal_masses().size(); ++n)
    sum += plant.nodal_masses()[n] * plant.positions().col(n).cross(plant.velocities().col(n));
  return sum;
}

}  // namespace palpate::object
