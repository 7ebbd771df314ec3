#include "tools/fit/experiments/spline.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <stdexcept>

namespace palpate::fit {

Spline::Spline(Eigen::VectorXd x, Eigen::VectorXd y) : x_(std::move(x)), y_(std::move(y)) {
  const Eigen::Index n = x_.size();
  if (n < 2 || y_.size() != n) throw std::invalid_argument("a spline needs two points or more");
  Eigen::MatrixXd A = Eigen::MatrixXd::Identity(n, n);
  bend_ = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 1; i + 1 < n; ++i) {
    const double left = x_[i] - x_[i - 1], right = x_[i + 1] - x_[i];
    A.row(i).segment<3>(i - 1) << left / 6, (left + right) / 3, right / 6;
    bend_[i] = (y_[i + 1] - y_[i]) / right - (y_[i] - y_[i - 1]) / left;
  }
  bend_ = A.partialPivLu().solve(bend_).eval();
}

Spline::Point Spline::at(double x) const {
  const Eigen::Index n = x_.size();
  const double inside = std::clamp(x, x_[0], x_[n - 1]);
  const Eigen::Index above = std::clamp<Eigen::Index>(
      std::upper_bound(x_.data(), x_.data() + n, inside) - x_.data(), 1, n - 1);
  const Eigen::Index k = above - 1;
  const double h = x_[above] - x_[k], b = (inside - x_[k]) / h, a = 1 - b;
  Point point;
  point.value = a * y_[k] + b * y_[above] +
                ((a * a * a - a) * bend_[k] + (b * b * b - b) * bend_[above]) * h * h / 6;
  point.slope = (y_[above] - y_[k]) / h +
                ((3 * b * b - 1) * bend_[above] - (3 * a * a - 1) * bend_[k]) * h / 6;
  point.value += point.slope * (x - inside);
  return point;
}

}  // namespace palpate::fit
