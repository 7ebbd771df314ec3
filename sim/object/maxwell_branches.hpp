#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/object/element_gradients.hpp"
#include "sim/object/neo_hookean.hpp"

namespace palpate::object {

/// A spring and a dashpot in series, beside the elastic solid.
struct MaxwellBranch {
  double relative_modulus = 0;  // of the spring over the solid's own: instantaneous = 1 + sum
  double relaxation_time = 0;   // s
};

/// Overstress of Maxwell branches at every Gauss point: a standard linear solid at finite strain.
///
/// Each branch stores half g (2 mu A:A + lambda (tr A)^2) with A = E - E_v, E the Green strain, and
/// its dashpot follows dE_v/dt = A / tau; its second Piola-Kirchhoff stress g (2 mu A + lambda
/// tr(A) I) adds to the elastic one (Holzapfel and Simo, Int. J. Solids Struct. 33 (1996) 3019,
/// eq. 30 with a quadratic branch energy; update: Taylor, Pister, Goudreau, IJNME 2 (1970) 45,
/// exact where the strain rate is even). It dissipates A:C:A / tau >= 0 for any deformation,
/// inverted ones too, and vanishes in rigid motions.
class MaxwellBranches {
 public:
  MaxwellBranches() = default;

  /// Throws std::invalid_argument where a modulus or a time is not positive.
  MaxwellBranches(const NeoHookean& material, const std::vector<MaxwellBranch>& branches,
                  int elements);

  bool empty() const { return branches_.empty(); }

  /// Time since the last deformation that was seen, s; 0: a sudden jump, infinity: all relaxed.
  void set_step(double h) noexcept;

  /// Moves on to the deformation gradients F of an element, in that lane, and adds the overstress
  /// to the first Piola-Kirchhoff stress. Returns how much stiffer than at rest the branches may
  /// be, at least 1.
  double add_stress(int element, int lane, const ElementGradients& F, ElementGradients& P) noexcept;

  /// Energy stored in the branches per rest volume, J/m^3.
  double energy_density(int element, int point) const noexcept;

  double relative_modulus() const { return relative_modulus_; }  // sum over the branches

 private:
  using Strains = Eigen::Matrix<double, 6, Eigen::Dynamic>;  // xx yy zz xy yz zx by point

  struct Branch {
    double relative_modulus = 0;
    double relaxation_time = 0;
    double keep = 1;  // of the old elastic strain after a step
    double take = 1;  // of the strain increment
    Strains elastic;  // A
  };

  NeoHookean material_;
  std::vector<Branch> branches_;
  double relative_modulus_ = 0;
  Strains strain_;  // E when last seen
};

}  // namespace palpate::object
