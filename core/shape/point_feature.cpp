#include "core/shape/point_feature.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace palpate::shape {

PointFeature::PointFeature(const mesh::ElementMesh& mesh, const Options& options)
    : points_(mesh, {options.rest_point}), components_(options.components) {
  std::vector<int> sorted = components_;
  std::sort(sorted.begin(), sorted.end());
  const bool different = std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end();
  if (sorted.empty() || !different || sorted.front() < 0 || sorted.back() > 2) {
    throw std::invalid_argument("components of a point feature must be different ones of x, y, z");
  }

  const Eigen::MatrixXd& weights = points_.weights();
  jacobian_.resize(dimension(), 3 * weights.cols());
  for (int row = 0; row < dimension(); ++row) {
    for (int i = 0; i < weights.cols(); ++i) {
      jacobian_.insert(row, 3 * i + components_[row]) = weights(0, i);
    }
  }
  jacobian_.makeCompressed();
}

void PointFeature::evaluate(const Eigen::Matrix3Xd& positions,
                            Eigen::Ref<Eigen::VectorXd> value) noexcept {
  value = points_.position(0, positions);
}

void PointFeature::error(const Eigen::Ref<const Eigen::VectorXd>& value,
                         const Eigen::Ref<const Eigen::VectorXd>& target,
                         Eigen::Ref<Eigen::VectorXd> error) const noexcept {
  for (int row = 0; row < dimension(); ++row) {
    error[row] = target[components_[row]] - value[components_[row]];
  }
}

bool PointFeature::is_valid_target(const double* target, int count) const noexcept {
  return count == 3 && std::isfinite(target[0]) && std::isfinite(target[1]) &&
         std::isfinite(target[2]);
}

}  // namespace palpate::shape
