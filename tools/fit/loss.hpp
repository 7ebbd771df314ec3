#pragma once

#include <cmath>

namespace palpate::fit {

/// Weight of a residual r, in standard deviations. Least squares are over rho(r) with rho(r)^2 =
///   none    r^2
///   huber   r^2 up to the scale a, then 2 a |r| - a^2 (Huber 1964)
///   cauchy  a^2 log(1 + r^2 / a^2)
struct Loss {
  enum class Kind { kNone, kHuber, kCauchy };
  Kind kind = Kind::kNone;
  double scale = 2;

  /// Replaces the residual by rho(r), and returns its slope.
  double apply(double& r) const {
    const double a = scale, size = std::abs(r);
    if (kind == Kind::kNone || size == 0) return 1;
    double slope = 1;
    if (kind == Kind::kHuber && size > a) {
      const double rho = std::sqrt(2 * a * size - a * a);
      slope = a / rho;
      r = std::copysign(rho, r);
    } else if (kind == Kind::kCauchy) {
      const double relative = size * size / (a * a);
      const double rho = a * std::sqrt(std::log1p(relative));
      slope = size / (rho * (1 + relative));
      r = std::copysign(rho, r);
    }
    return slope;
  }
};

}  // namespace palpate::fit
