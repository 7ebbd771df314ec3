#pragma once

#include <cstdint>
#include <string>

namespace palpate::uncertainty {

/// Latin hypercube (McKay, Beckman and Conover 1979): of `count` draws each parameter has exactly
/// one in every count-th part of [0, 1), in an order of its own. The numbers of a parameter depend
/// on seed, count and its name alone, so that another parameter does not change them.
class LatinHypercube {
 public:
  /// Throws std::invalid_argument unless count >= 1.
  LatinHypercube(std::uint64_t seed, int count);

  int count() const { return count_; }
  std::uint64_t seed() const { return seed_; }
  /// In [0, 1), of the draw `index`, 0 to count - 1. Throws std::out_of_range.
  double at(const std::string& parameter, int index) const;

 private:
  std::uint64_t seed_;
  int count_;
};

/// Quantile, in standard deviations, of the standard normal distribution truncated to
/// [lower, upper], which lie within [-3, 3]; `share` in [0, 1). Without transcendental functions:
/// the same on every machine.
double truncated_normal(double share, double lower, double upper);

/// Quantile of the half-normal distribution |z| with |z| <= upper.
double half_normal(double share, double upper);

}  // namespace palpate::uncertainty
