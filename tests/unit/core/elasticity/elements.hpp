#pragma once

#include "core/elasticity/element_forces.hpp"
#include "core/elasticity/element_set.hpp"

namespace palpate::elasticity {

struct Answer {
  double energy = 0;
  Eigen::Matrix3Xd forces;
};

/// The elements of a body, evaluated for forces in the numbering of its mesh.
class Elements {
 public:
  explicit Elements(const Body& body, Precision precision = Precision::kDouble)
      : matrices(body),
        forces_(make_element_forces(body.mesh, matrices.materials(), mesh_numbering(body.mesh),
                                    precision)) {}

  Answer evaluate(const Eigen::Matrix3Xd& x, double viscosity = 0) {
    NodalField padded = NodalField::Zero(4, x.cols()), f = padded;
    padded.topRows<3>() = x;
    const double energy = forces_->add(padded, viscosity, f);
    return {energy, f.topRows<3>()};
  }
  void begin_step() { forces_->begin_step(); }
  ElementForces& forces() { return *forces_; }

  const ElementSet matrices;

 private:
  std::unique_ptr<ElementForces> forces_;
};

}  // namespace palpate::elasticity
