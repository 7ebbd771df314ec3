#include "tests/bench/core/elasticity/samples.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <numeric>

namespace palpate::bench {
namespace {

double seconds(clockid_t clock) noexcept {
  timespec t{};
  clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace

double wall_time() noexcept { return seconds(CLOCK_MONOTONIC); }
double thread_time() noexcept { return seconds(CLOCK_THREAD_CPUTIME_ID); }

double Samples::mean() const {
  if (values_.empty()) return 0;
  return std::accumulate(values_.begin(), values_.end(), 0.0) / static_cast<double>(count());
}

double Samples::max() const {
  return values_.empty() ? 0 : *std::max_element(values_.begin(), values_.end());
}

double Samples::quantile(double fraction) const {
  if (values_.empty()) return 0;
  const double rank = std::ceil(fraction * static_cast<double>(count()));
  const auto index =
      static_cast<std::ptrdiff_t>(std::clamp(rank - 1, 0.0, static_cast<double>(count()) - 1));
  std::vector<double> sorted = values_;
  std::nth_element(sorted.begin(), sorted.begin() + index, sorted.end());
  return sorted[static_cast<std::size_t>(index)];
}

}  // namespace palpate::bench
