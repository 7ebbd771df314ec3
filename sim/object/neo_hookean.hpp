#pragma once

#include <stdexcept>

namespace palpate::object {

/// Lame constants of the plant.
struct NeoHookean {
  double shear_modulus = 0;  // mu, Pa
  double lame = 0;           // lambda, Pa

  /// Throws std::invalid_argument unless E > 0 and 0 <= nu < 0.5.
  static NeoHookean from_young(double young_modulus, double poisson_ratio) {
    if (!(young_modulus > 0) || !(poisson_ratio >= 0 && poisson_ratio < 0.5))
      throw std::invalid_argument("plant: needs young_modulus > 0 and 0 <= poisson_ratio < 0.5");
    return {young_modulus / (2 * (1 + poisson_ratio)),
            young_modulus * poisson_ratio / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio))};
  }

  double young_modulus() const {
    return shear_modulus * (3 * lame + 2 * shear_modulus) / (lame + shear_modulus);
  }
};

}  // namespace palpate::object
