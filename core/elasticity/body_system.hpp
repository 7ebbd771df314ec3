#pragma once

#include "core/elasticity/mesh_forces.hpp"
#include "core/factor/supernodal_factor.hpp"

namespace palpate::elasticity {

/// Double-precision data of a solver for one body: elements, a matrix over the unknown nodes with
/// its factor, and forces. Members refer to each other.
struct BodySystem {
  explicit BodySystem(const Body& body)
      : elements(body),
        pattern(body.mesh.elements, body.mesh.node_count(), body.fixed_nodes, patches(body)),
        supernodes(pattern),
        matrix(pattern),
        factor(supernodes),
        forces(body.mesh, elements.materials()) {}
  BodySystem(const BodySystem&) = delete;
  BodySystem& operator=(const BodySystem&) = delete;

  ElementSet elements;
  factor::BlockPattern pattern;
  factor::Supernodes supernodes;
  factor::BlockMatrix matrix;
  factor::SupernodalFactor factor;
  MeshForces forces;
};

}  // namespace palpate::elasticity
