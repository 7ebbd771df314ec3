#include "tools/common/bootstrap.hpp"

#include <algorithm>
#include <cmath>

#include "core/math/random.hpp"
#include "tools/common/table.hpp"

namespace palpate::common {
namespace {

constexpr int kResamples = 2000;
constexpr double kTail = 0.025;
constexpr double kDeviations = 1.959964;  // of a normal distribution, about 95 % coverage

double middle(std::vector<double>& values) {
  const std::size_t half = values.size() / 2;
  const auto upper = values.begin() + static_cast<std::ptrdiff_t>(half);
  std::nth_element(values.begin(), upper, values.end());
  if (values.size() % 2 == 1) return *upper;
  return 0.5 * (*upper + *std::max_element(values.begin(), upper));
}

}  // namespace

Interval95 median_of(std::vector<double> values) {
  math::Random random(1, "bootstrap");
  std::vector<double> medians(kResamples), drawn(values.size());
  for (double& median : medians) {
    for (double& value : drawn) value = values[random.below(values.size())];
    median = middle(drawn);
  }
  std::sort(medians.begin(), medians.end());
  const auto quantile = [&medians](double q) {
    return medians[static_cast<std::size_t>(std::lround(q * (kResamples - 1)))];
  };
  return {middle(values), quantile(kTail), quantile(1 - kTail)};
}

Interval95 share_of(int successes, int trials) {
  const double n = trials, p = successes / n, z2 = kDeviations * kDeviations;
  const double centre = (p + z2 / (2 * n)) / (1 + z2 / n);
  const double half = kDeviations / (1 + z2 / n) * std::sqrt(p * (1 - p) / n + z2 / (4 * n * n));
  return {p, std::max(0.0, centre - half), std::min(1.0, centre + half)};
}

std::string median_and_interval(const std::vector<double>& values, int decimals) {
  if (values.empty()) return kNotAvailable;
  const Interval95 median = median_of(values);
  const std::string text = number(median.value, decimals);
  if (values.size() == 1) return text;
  return text + " (" + number(median.low, decimals) + " to " + number(median.high, decimals) + ")";
}

std::string share_and_interval(int successes, int trials) {
  if (trials == 0) return kNotAvailable;
  const Interval95 share = share_of(successes, trials);
  return number(100 * share.value, 0) + " % (" + number(100 * share.low, 0) + " to " +
         number(100 * share.high, 0) + ")";
}

}  // namespace palpate::common
