#include "core/shape/points_feature.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace palpate::shape {
namespace {

const std::vector<Eigen::Vector3d>& checked(const std::vector<Eigen::Vector3d>& points) {
  if (points.empty() || points.size() > PointsFeature::kMostPoints) {
    throw std::invalid_argument("a points feature has 1 to " +
                                std::to_string(PointsFeature::kMostPoints) + " points, not " +
                                std::to_string(points.size()));
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if ((points[i] - points[k]).norm() < PointsFeature::kNearestPair) {
        throw std::invalid_argument("points " + std::to_string(k) + " and " + std::to_string(i) +
                                    " of a points feature are nearer than 1 mm");
      }
    }
  }
  return points;
}

}  // namespace

PointsFeature::PointsFeature(const mesh::ElementMesh& mesh, const Options& options)
    : points_(mesh, checked(options.rest_points)) {
  const Eigen::MatrixXd& weights = points_.weights();
  std::vector<Eigen::Triplet<double>> entries;
  for (int p = 0; p < weights.rows(); ++p) {
    for (int i = 0; i < weights.cols(); ++i) {
      if (weights(p, i) == 0) continue;
      for (int axis = 0; axis < 3; ++axis)
        entries.emplace_back(3 * p + axis, 3 * i + axis, weights(p, i));
    }
  }
  jacobian_.resize(dimension(), 3 * weights.cols());
  jacobian_.setFromTriplets(entries.begin(), entries.end());
}

void PointsFeature::evaluate(const Eigen::Matrix3Xd& positions,
                             Eigen::Ref<Eigen::VectorXd> value) noexcept {
  for (int p = 0; p < points_.count(); ++p) {
    value.segment<3>(3 * p) = points_.position(p, positions);
  }
}

void PointsFeature::error(const Eigen::Ref<const Eigen::VectorXd>& value,
                          const Eigen::Ref<const Eigen::VectorXd>& target,
                          Eigen::Ref<Eigen::VectorXd> error) const noexcept {
  error = target - value;
}

bool PointsFeature::is_valid_target(const double* target, int count) const noexcept {
  return count == value_count() &&
         std::all_of(target, target + count, [](double v) { return std::isfinite(v); });
}

}  // namespace palpate::shape
