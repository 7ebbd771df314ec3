#pragma once

#include "core/elasticity/element_forces.hpp"
#include "core/elasticity/element_set.hpp"
#include "core/factor/supernodal_factor.hpp"

namespace palpate::elasticity {

/// Forces of all elements in double precision, in mesh numbering and without viscosity.
class MeshForces {
 public:
  MeshForces(const mesh::ElementMesh& mesh, const ElementMaterials& materials)
      : elements_(make_element_forces(mesh, materials, mesh_numbering(mesh), Precision::kDouble)),
        x_(NodalField::Zero(4, mesh.node_count())),
        forces_(x_) {}

  /// `forces` = dEnergy/dx, N, at positions x, both 3 x n; returns the energy, J.
  double evaluate(const Eigen::Matrix3Xd& x, Eigen::Matrix3Xd& forces) {
    x_.topRows<3>() = x;
    forces_.setZero();
    const double energy = elements_->add(x_, 0, forces_);
    forces = forces_.topRows<3>();
    return energy;
  }

  void reset() noexcept { elements_->reset(); }

 private:
  std::unique_ptr<ElementForces> elements_;
  NodalField x_, forces_;
};

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
