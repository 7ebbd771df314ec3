#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/object/element_gradients.hpp"
#include "sim/object/neo_hookean.hpp"

namespace palpate::object {

/// A spring and a dashpot in series, in parallel with the elastic solid.
struct MaxwellBranch {
  double relative_modulus =
      0;  // spring stiffness relative to the solid's own: instantaneous = 1 + sum
  double relaxation_time = 0;  // s
};

/// Overstress of Maxwell branches at every Gauss point: a standard linear solid at finite strain.
///
/// Each branch stores half g (2 mu A:A + lambda (tr A)^2) with A = E - E_v, E the Green strain, and
/// its dashpot follows dE_v/dt = A / tau; its second Piola-Kirchhoff stress g (2 mu A + lambda
/// tr(A) I) adds to the elastic one (Holzapfel and Simo, Int. J. Solids Struct. 33 (1996) 3019, eq.
/// 30 with a quadratic branch energy; update: Taylor, Pister, Goudreau, IJNME 2 (1970) 45, exact
/// for a constant strain rate). It dissipates A:C:A / tau >= 0 for any deformation, also inverted
/// ones, and vanishes in rigid motions.
class MaxwellBranches {
 public:
  MaxwellBranches() = default;

  /// Throws std::invalid_argument if a modulus or a time is not positive.
  MaxwellBranches(const NeoHookean& material, const std::vector<MaxwellBranch>& branches,
                  int elements);

  bool empty() const { return branches_.empty(); }

  /// Time since the last deformation passed in, s; 0: a sudden jump, infinity: fully relaxed.
  void set_step(double h) noexcept;

  /// Advances to the deformation gradients F of an element, in that lane, and adds the overstress
  /// to the first Piola-Kirchhoff stress. Returns the stiffness of the branches relative to rest,
  /// at least 1.
  double add_stress(int element, int lane, const ElementGradients& F, ElementGradients& P) noexcept;

  /// Energy stored in the branches per rest volume, J/m^3.
  double energy_density(int element, int point) const noexcept;

  double relative_modulus() const { return relative_modulus_; }  // sum over the branches

 private:
  using Strains = Eigen::Matrix<double, 6, Eigen::Dynamic>;  // xx yy zz xy yz zx by point

  struct Branch {
    double relative_modulus = 0;
    double relaxation_time = 0;
    double keep = 1;  // weight of the old elastic strain after a step
    double take = 1;  // weight of the strain increment
    Strains elastic;  // A
  };

  NeoHookean material_;
  std::vector<Branch> branches_;
  double relative_modulus_ = 0;
  Strains strain_;  // E at the last call
};

}  // namespace palpate::object
