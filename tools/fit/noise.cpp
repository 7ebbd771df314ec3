#include "tools/fit/noise.hpp"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
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
  return boost::math::quantile(boost::math::students_t(std::max(freedom, 1.0)), 0.975);
}

}  // namespace palpate::fit
