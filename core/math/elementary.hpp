#pragma once

#include <Eigen/Core>
#include <cmath>

#include "core/math/pack.hpp"

namespace palpate::math {

/// A number as a pack of one, for formulas that hold for numbers and packs.
template <>
struct PackTraits<double> {
  using Real = double;
  static constexpr int kLanes = 1;
};

inline bool all(bool condition) { return condition; }

namespace detail {

/// Function of Eigen's arrays, which has vector instructions for it, applied to a pack.
template <class Pack, class Function>
inline Pack by_array(Pack x, const Function& function) {
  Eigen::Array<typename PackTraits<Pack>::Real, kLanes<Pack>, 1> a;
  std::memcpy(a.data(), &x, sizeof(x));
  a = function(a).eval();
  std::memcpy(&x, a.data(), sizeof(x));
  return x;
}

}  // namespace detail

/// Lane by lane.
template <class Pack>
inline Pack exp(Pack x) {
  return detail::by_array(x, [](const auto& a) { return a.exp(); });
}
template <class Pack>
inline Pack log(Pack x) {
  return detail::by_array(x, [](const auto& a) { return a.log(); });
}
template <class Pack>
inline Pack sqrt(Pack x) {
  return detail::by_array(x, [](const auto& a) { return a.sqrt(); });
}
template <class Pack>
inline Pack abs(Pack x) {
  return x < 0 ? -x : x;
}

}  // namespace palpate::math
