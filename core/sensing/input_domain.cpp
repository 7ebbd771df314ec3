#include "core/sensing/input_domain.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/math/option_check.hpp"

namespace palpate::sensing {

double InputDomain::trust(const Eigen::Ref<const Eigen::VectorXd>& input) const noexcept {
  if (points.cols() == 0) return 1;
  double nearest = far * far;
  for (Eigen::Index p = 0; p < points.cols(); ++p) {
    double square = 0;
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
      const double distance = (input[i] - points(i, p)) / deviation[i];
      square += distance * distance;
    }
    if (square < nearest) nearest = square;  // false for NaN
  }
  const double way = std::clamp((std::sqrt(nearest) - near) / (far - near), 0.0, 1.0);
  return 1 - way * way * (3 - 2 * way);
}

void InputDomain::check(int inputs) const {
  if (points.cols() == 0) return;
  const std::string each = std::to_string(inputs) + " rows, one for each input";
  math::check_option(points.cols() <= kLargestPoints, "domain.points", points.cols(),
                     "at most " + std::to_string(kLargestPoints) + " points");
  math::check_option(points.rows() == inputs, "domain.points", points.rows(), each);
  math::check_option(deviation.size() == inputs, "domain.deviation", deviation.size(), each);
  math::check_all_finite(points, "domain.points");
  math::check_all_finite(deviation, "domain.deviation");
  math::check_option((deviation.array() > 0).all(), "domain.deviation", deviation.transpose(),
                     "above 0");
  math::check_not_negative(near, "domain.near");
  math::check_option(far > near && std::isfinite(far), "domain.far", far,
                     "above near, " + std::to_string(near) + ", and finite");
}

InputDomain cover(const Eigen::MatrixXd& rows, const Eigen::VectorXd& deviation, int count,
                  double near_factor, double far_factor) {
  math::check_option(rows.rows() > 0, "rows", rows.rows(), "at least one row");
  const Eigen::MatrixXd scaled = rows * deviation.cwiseInverse().asDiagonal();
  const auto square_distances = [&](const Eigen::RowVectorXd& point) -> Eigen::VectorXd {
    return (scaled.rowwise() - point).rowwise().squaredNorm();
  };
  InputDomain domain;
  domain.deviation = deviation;
  count = static_cast<int>(std::min<Eigen::Index>(count, rows.rows()));
  domain.points.resize(rows.cols(), count);
  Eigen::Index next = 0;
  square_distances(scaled.colwise().mean()).minCoeff(&next);
  Eigen::VectorXd nearest = square_distances(scaled.row(next));
  for (int p = 0; p < count; ++p) {
    domain.points.col(p) = rows.row(next).transpose();
    nearest = nearest.cwiseMin(square_distances(scaled.row(next)));
    nearest.maxCoeff(&next);
  }
  // If all rows are points, the remaining distance is zero, and the weight would be a step
  // function.
  const double left = std::max(std::sqrt(nearest.maxCoeff()), 1e-3);
  domain.near = near_factor * left;
  domain.far = far_factor * left;
  domain.check(static_cast<int>(rows.cols()));
  return domain;
}

}  // namespace palpate::sensing
