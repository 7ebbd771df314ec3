#pragma once

#include <vector>

#include "core/elasticity/element_forces.hpp"
#include "core/elasticity/element_set.hpp"
#include "core/math/pack.hpp"
#include "core/math/team.hpp"

namespace palpate::elasticity {

/// Consistent mass matrix in a solver's numbering, stored by rows.
class Inertia {
 public:
  /// `team` must outlive this object.
  Inertia(const ElementSet& elements, const std::vector<int>& numbering,
          math::Team& team = math::solo_team);

  /// Adds factor M (x - y) to `forces`; returns factor/2 |x - y|^2_M.
  double add(const NodalField& x, const NodalField& y, double factor, NodalField& forces) noexcept;

  /// factor/2 |v|^2_M.
  double energy(const NodalField& v, double factor) const noexcept;

 private:
  struct alignas(64) Energy {
    math::Pack4d sum;
  };

  math::Team& team_;
  std::vector<int> row_start_, column_;  // columns as offsets in a nodal field
  std::vector<double> mass_;             // kg
  std::vector<Energy> energies_;         // energies of the members
};

}  // namespace palpate::elasticity
