#include "tools/fit/noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace palpate::fit {

double autocorrelation_factor(const Eigen::VectorXd& residuals) {
  const Eigen::Index n = residuals.size();
  if (n < 4) return 1;
  const Eigen::VectorXd r = residuals.array() - residuals.mean();
  const double variance = r.squaredNorm();
  if (!(variance > 0)) return 1;
  const auto rho = [&](Eigen::Index lag) {
    return lag < n ? r.head(n - lag).dot(r.tail(n - lag)) / variance : 0.0;
  };
  const double white = 1.96 / std::sqrt(static_cast<double>(n));
  if (rho(1) < white) return 1;
  double sum = rho(1);
  for (Eigen::Index lag = 2; lag + 1 < n; lag += 2) {
    const double pair = rho(lag) + rho(lag + 1);
    if (!(pair > 0)) break;
    sum += pair;
  }
  return std::clamp(1 + 2 * sum, 1.0, static_cast<double>(n) / 2);
}

double student_quantile(double freedom) {
  // Exact below 5; above, the Cornish-Fisher expansion (Abramowitz and Stegun 26.7.5).
  constexpr std::array<double, 5> kFew = {12.7062, 12.7062, 4.30265, 3.18245, 2.77645};
  if (freedom < 5) {
    const double v = std::max(freedom, 1.0);
    const auto below = static_cast<std::size_t>(v);
    const double above = below + 1 < kFew.size() ? kFew[below + 1] : 2.57058;
    return kFew[below] + (v - static_cast<double>(below)) * (above - kFew[below]);
  }
  const double z = 1.959964, v = freedom;
  return z + (std::pow(z, 3) + z) / (4 * v) +
         (5 * std::pow(z, 5) + 16 * std::pow(z, 3) + 3 * z) / (96 * v * v) +
         (3 * std::pow(z, 7) + 19 * std::pow(z, 5) + 17 * std::pow(z, 3) - 15 * z) /
             (384 * v * v * v);
}

}  // namespace palpate::fit
