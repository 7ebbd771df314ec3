#include "core/shape/fourier_contour_feature.hpp"

#include <cmath>
#include <string>

#include "core/math/option_check.hpp"
#include "core/math/singular_values.hpp"
#include "core/shape/point_features.hpp"

namespace palpate::shape {
namespace {

/// Condition number of the least-squares fit above which the coefficients are not determined.
constexpr double kWorstCondition = 20;

/// Arc length along the polygon up to each point, as a fraction of the total.
Eigen::VectorXd arc_of(const std::vector<Eigen::Vector3d>& points, bool closed) {
  Eigen::VectorXd arc(points.size());
  arc[0] = 0;
  for (int p = 1; p < arc.size(); ++p) arc[p] = arc[p - 1] + (points[p] - points[p - 1]).norm();
  const double closing = closed ? (points.front() - points.back()).norm() : 0;
  return arc / (arc[arc.size() - 1] + closing);
}

/// Row p: contribution of each coefficient to the contour at point p.
Eigen::MatrixXd waves_at(const Eigen::VectorXd& arc, int harmonics, bool closed) {
  Eigen::MatrixXd waves(arc.size(), 1 + (closed ? 2 : 1) * harmonics);
  waves.col(0).setOnes();
  for (int k = 1; k <= harmonics; ++k) {
    const Eigen::ArrayXd phase = (closed ? 2 : 1) * M_PI * k * arc.array();
    if (closed) {
      waves.col(2 * k - 1) = phase.cos();
      waves.col(2 * k) = phase.sin();
    } else {
      waves.col(k) = phase.cos();
    }
  }
  return waves;
}

Eigen::MatrixXd fit_of(const FourierContourFeature::Options& options) {
  const int points = static_cast<int>(options.rest_points.size());
  const char* const kHarmonics = "feature fourier_contour: harmonics";
  math::check_option(options.harmonics >= 1 && options.harmonics < points, kHarmonics,
                     options.harmonics, "1 to below the " + std::to_string(points) + " points");
  const Eigen::MatrixXd waves =
      waves_at(arc_of(options.rest_points, options.closed), options.harmonics, options.closed);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(waves, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::VectorXd& singular = svd.singularValues();
  math::check_option(
      waves.cols() <= points && singular[0] <= kWorstCondition * singular[singular.size() - 1],
      kHarmonics, options.harmonics,
      "fewer, which " + std::to_string(points) + " points so placed can resolve");
  return svd.solve(Eigen::MatrixXd::Identity(points, points));
}

}  // namespace

FourierContourFeature::FourierContourFeature(const mesh::ElementMesh& mesh, const Options& options)
    : MaterialFeature(mesh, checked_points("fourier_contour", options.rest_points, 3, kMostPoints)),
      components_(checked_components("fourier_contour", options.components)),
      fit_(fit_of(options)) {
  const int count = static_cast<int>(fit_.rows());
  Eigen::MatrixXd by_points = Eigen::MatrixXd::Zero(count * components_.size(), 3 * point_count());
  for (std::size_t c = 0; c < components_.size(); ++c) {
    for (int p = 0; p < point_count(); ++p) {
      by_points.block(c * count, 3 * p + components_[c], count, 1) = fit_.col(p);
    }
  }
  set_constant(by_points);
}

void FourierContourFeature::evaluate(const Eigen::Matrix3Xd& positions,
                                     Eigen::Ref<Eigen::VectorXd> value) noexcept {
  const Eigen::Index count = fit_.rows();
  value.setZero();
  for (int p = 0; p < point_count(); ++p) {
    const Eigen::Vector3d point = position(p, positions);
    for (std::size_t c = 0; c < components_.size(); ++c) {
      value.segment(c * count, count) += point[components_[c]] * fit_.col(p);
    }
  }
}

}  // namespace palpate::shape
