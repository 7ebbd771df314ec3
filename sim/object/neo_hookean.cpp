#include "sim/object/neo_hookean.hpp"

#include <stdexcept>

namespace palpate::object {

NeoHookean NeoHookean::from_young(double young_modulus, double poisson_ratio) {
  if (!(young_modulus > 0) || !(poisson_ratio >= 0 && poisson_ratio < 0.5)) {
    throw std::invalid_argument("plant: needs young_modulus > 0 and 0 <= poisson_ratio < 0.5");
  }
  return {young_modulus / (2 * (1 + poisson_ratio)),
          young_modulus * poisson_ratio / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio))};
}

}  // namespace palpate::object
