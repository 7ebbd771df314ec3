#pragma once

#include <array>

#include "core/elasticity/stretch_law.hpp"
#include "core/math/elementary.hpp"

// Energy, stress and tangent of StretchLaw, for a number or a pack.
namespace palpate::elasticity {

/// q(a, x) = (exp(a x) - 1) / a, its integral from 0 to x, and derivatives. Without cancellation:
/// they follow from phi(y) = (exp(y) - 1 - y) / y^2, y = a x, by a series where y is small.
template <class N>
struct PowerTerm {
  PowerTerm(double exponent, N x_in) : x(x_in), y(math::splat<N>(exponent) * x_in) {
    constexpr double kSmall = 0.25;         // beyond it the closed form loses less than two digits
    phi = math::splat<N>(1.0 / 479001600);  // 1/12!, then 1/11! to 1/2!
    for (double factorial :
         {39916800.0, 3628800.0, 362880.0, 40320.0, 5040.0, 720.0, 120.0, 24.0, 6.0, 2.0})
      phi = phi * y + math::splat<N>(1 / factorial);
    const auto small = math::abs(y) < math::splat<N>(kSmall);
    by_x = 1 + (y + y * y * phi);
    if (math::all(small)) return;
    const N power = math::exp(y);
    phi = small ? phi : (power - 1 - y) / (y * y);
    by_x = small ? by_x : power;
  }

  N value() const { return x + x * y * phi; }
  N integral() const { return x * x * phi; }
  N by_exponent() const { return x * x * (1 + (y - 1) * phi); }  // of the value

  N x, y, by_x, phi;
};

/// log(1 + e) = 2 artanh z without cancellation, by a series where e is small; z = e / (2 + e).
template <class N>
inline N log_stretch(N e, N z) {
  constexpr double kSmall = 0.25;
  const N z2 = z * z;
  N series = math::splat<N>(2.0 / 21);
  for (double odd : {19, 17, 15, 13, 11, 9, 7, 5, 3, 1})
    series = series * z2 + math::splat<N>(2 / odd);
  series *= z;
  const auto small = math::abs(e) < math::splat<N>(kSmall);
  if (math::all(small)) return series;
  return small ? series : math::log(1 + e);
}

/// Energy and its derivatives by the logarithms x_k of the principal stretches.
template <class N>
struct StretchResponse {
  N energy{};
  std::array<N, 3> stress{};   // by x_k: principal Kirchhoff stress
  std::array<N, 6> tangent{};  // by x_k and x_l: xx yy zz xy xz yz
};

/// W of StretchLaw.
template <class N>
inline StretchResponse<N> shear_response(const StretchLaw& law, const std::array<N, 3>& x) {
  StretchResponse<N> r;
  for (int i = 0; i < law.terms; ++i) {
    const N weight = math::splat<N>(2 * law.shares[i]);
    for (int k = 0; k < 3; ++k) {
      const PowerTerm<N> q(law.exponents[i], x[k]);
      r.energy += weight * q.integral();
      r.stress[k] += weight * q.value();
      r.tangent[k] += weight * q.by_x;
    }
  }
  if (law.cofactor_share == 0) return r;
  const N l = x[0] + x[1] + x[2], weight = math::splat<N>(2 * law.cofactor_share);
  for (int k = 0; k < 3; ++k) {
    const PowerTerm<N> q(2, l - x[k]);  // depends on the other two logarithms
    const int m = (k + 1) % 3, n = (k + 2) % 3;
    const N stress = weight * q.value(), tangent = weight * q.by_x;
    r.energy += weight * q.integral();
    r.stress[m] += stress;
    r.stress[n] += stress;
    r.tangent[m] += tangent;
    r.tangent[n] += tangent;
    r.tangent[5 - k] += tangent;
  }
  r.energy -= math::splat<N>(law.cofactor_share) * l * l;
  for (N& stress : r.stress) stress -= weight * l;
  for (N& tangent : r.tangent) tangent -= weight;
  return r;
}

/// Psi of StretchLaw.
template <class N>
inline StretchResponse<N> respond(const StretchLaw& law, N mu, N lambda,
                                  const std::array<N, 3>& x) {
  StretchResponse<N> r = shear_response(law, x);
  const N l = x[0] + x[1] + x[2];
  r.energy = mu * r.energy + math::splat<N>(0.5) * lambda * l * l;
  for (N& stress : r.stress) stress = mu * stress + lambda * l;
  for (N& tangent : r.tangent) tangent = mu * tangent + lambda;
  return r;
}

}  // namespace palpate::elasticity
