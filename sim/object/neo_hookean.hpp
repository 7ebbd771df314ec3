#pragma once

namespace palpate::object {

/// Lame constants of the plant.
struct NeoHookean {
  double shear_modulus = 0;  // mu, Pa
  double lame = 0;           // lambda, Pa

  /// Throws std::invalid_argument unless E > 0 and 0 <= nu < 0.5.
  static NeoHookean from_young(double young_modulus, double poisson_ratio);

  double young_modulus() const {
    return shear_modulus * (3 * lame + 2 * shear_modulus) / (lame + shear_modulus);
  }
};

}  // namespace palpate::object
