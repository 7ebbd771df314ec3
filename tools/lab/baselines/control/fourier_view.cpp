#include "tools/lab/baselines/control/fourier_view.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/math/constants.hpp"

namespace palpate::baselines {
namespace {

using math::kPi;

}  // namespace

void FourierView::resize(const shape::Feature& feature) {
  check_points(feature);
  if (options_.harmonics < 0 || options_.harmonics > 15)
    throw std::invalid_argument("harmonics must lie in 0 to 15");
  const std::vector<Eigen::Vector3d>& points = feature.rest_points();
  const int count = static_cast<int>(points.size());
  if (feature.dimension() != 3 * count)
    throw std::invalid_argument("a contour needs all components of its points");
  Eigen::VectorXd arc = Eigen::VectorXd::Zero(count);
  for (int p = 1; p < count; ++p) arc[p] = arc[p - 1] + (points[p] - points[p - 1]).norm();
  const double whole =
      arc[count - 1] + (options_.closed ? (points.front() - points.back()).norm() : 0);
  if (whole > 0) arc /= whole;
  const int harmonics = std::min(options_.harmonics, options_.closed ? (count - 1) / 2 : count - 1);
  const int waves = 1 + (options_.closed ? 2 : 1) * harmonics;
  synthesis_.setZero(3 * count, 3 * waves);
  for (int p = 0; p < count; ++p) {
    for (int w = 0; w < waves; ++w) {
      const int k = options_.closed ? (w + 1) / 2 : w;
      const double phase = (options_.closed ? 2 : 1) * kPi * k * arc[p];
      const bool sine = options_.closed && w > 0 && w % 2 == 0;
      synthesis_.block<3, 3>(3 * p, 3 * w)
          .diagonal()
          .setConstant(sine ? std::sin(phase) : std::cos(phase));
    }
  }
  analysis_ = synthesis_.completeOrthogonalDecomposition().pseudoInverse();
}

}  // namespace palpate::baselines
