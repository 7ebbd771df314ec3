#include "tools/lab/uncertainty/latin_hypercube.hpp"

#include <numeric>
#include <stdexcept>
#include <utility>
#include <vector>

#include "core/math/random.hpp"

namespace palpate::uncertainty {
namespace {

/// Integral of exp(-t^2 / 2) from 0 to x, by its alternating series; |x| <= 3.
double bell(double x) {
  constexpr int kTerms = 60;  // 3^121 / (60! 2^60 121) is below 1e-44
  double power = x, sum = x;
  for (int k = 1; k < kTerms; ++k) {
    power *= -x * x / (2 * k);
    sum += power / (2 * k + 1);
  }
  return sum;
}

}  // namespace

LatinHypercube::LatinHypercube(std::uint64_t seed, int count) : seed_(seed), count_(count) {
  if (count < 1)
    throw std::invalid_argument("draws: " + std::to_string(count) + " is not allowed; at least 1");
}

double LatinHypercube::at(const std::string& parameter, int index) const {
  if (index < 0 || index >= count_)
    throw std::out_of_range("draw " + std::to_string(index + 1) + " of " + std::to_string(count_));
  math::Random random(seed_, parameter);
  std::vector<int> strata(static_cast<std::size_t>(count_));
  std::iota(strata.begin(), strata.end(), 0);
  for (std::size_t i = strata.size(); i > 1; --i)
    std::swap(strata[i - 1], strata[static_cast<std::size_t>(random.below(i))]);
  double within = random.uniform();
  for (int i = 0; i < index; ++i) within = random.uniform();
  return (strata[static_cast<std::size_t>(index)] + within) / count_;
}

double truncated_normal(double share, double lower, double upper) {
  constexpr int kHalvings = 60;
  const double goal = bell(lower) + share * (bell(upper) - bell(lower));
  double below = lower, above = upper;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (below + above);
    (bell(middle) < goal ? below : above) = middle;
  }
  return 0.5 * (below + above);
}

double half_normal(double share, double upper) { return truncated_normal(share, 0, upper); }

}  // namespace palpate::uncertainty
