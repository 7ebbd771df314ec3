#pragma once

#include <array>
#include <string>
#include <vector>

namespace palpate::elasticity {

/// Isotropic hyperelastic law by powers of the principal stretches: energy per rest volume, Pa,
///   Psi = mu W + lambda/2 l^2,  x_k = log of stretch k, l = x_1 + x_2 + x_3 = log J,
///   W = 2 sum_i share_i sum_k Q(exponent_i, x_k) + 2 cofactor_share (sum_k Q(2, l - x_k) - l^2/2),
/// where Q(a, x) is the integral of (exp(a x) - 1) / a from 0 to x. The shares and cofactor_share
/// sum to 1; mu and lambda are then Lame's parameters at small strain, and Psi is linear in them.
struct StretchLaw {
  int terms = 1;  // 1 or 2
  std::array<double, 2> exponents{2, 2};
  std::array<double, 2> shares{1, 0};  // of the shear modulus
  double cofactor_share = 0;

  bool operator==(const StretchLaw& other) const {
    return terms == other.terms && exponents == other.exponents && shares == other.shares &&
           cofactor_share == other.cofactor_share;
  }
};

/// Law by its name, with the constants that palpate-fit determines in addition to the moduli.
struct NamedStretchLaw {
  struct Constant {
    std::string name, description;
    double start = 0;             // plausible initial value
    double lower = 0, upper = 0;  // permitted range, bounds included
  };
  std::string name, description;
  std::vector<Constant> constants;  // ratios: first exponents, then shares of the shear modulus
  int exponents = 0;                // number of the former
  StretchLaw (*make)(const std::vector<double>& constants);
};

///   neo_hookean    mu/2 (I1 - 3) - mu l + lambda/2 l^2 (Bonet and Wood 2008, eq. 6.27)
///   mooney_rivlin  c10 (I1 - 3) + c01 (I2 - 3) - (2 c10 + 4 c01) l + (lambda - 4 c01) l^2/2,
///                  c01 = share mu/2, c10 = (1 - share) mu/2; `mooney_share`
///   ogden_1, _2    2 sum_i mu_i sum_k Q(a_i, x_k) + lambda/2 l^2, mu_2 = share mu;
///                  `ogden_exponent`, `ogden_exponent_2`, `ogden_share_2` (Ogden 1972)
const std::vector<NamedStretchLaw>& stretch_laws();

/// The law of this name, null if there is none.
const NamedStretchLaw* find_stretch_law(const std::string& name);

}  // namespace palpate::elasticity
