#include "core/shape/point_feature.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace palpate::shape {

const std::vector<int>& checked_components(const char* kind, const std::vector<int>& components) {
  std::vector<int> sorted = components;
  std::sort(sorted.begin(), sorted.end());
  const bool different = std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end();
  if (sorted.empty() || !different || sorted.front() < 0 || sorted.back() > 2) {
    throw std::invalid_argument("feature " + std::string(kind) +
                                ": components must be different ones of x, y, z");
  }
  return components;
}

PointFeature::PointFeature(const mesh::ElementMesh& mesh, const Options& options)
    : MaterialFeature(mesh, {options.rest_point}),
      components_(checked_components("point", options.components)) {
  Eigen::MatrixXd by_point = Eigen::MatrixXd::Zero(components_.size(), 3);
  for (int row = 0; row < by_point.rows(); ++row) by_point(row, components_[row]) = 1;
  set_constant(by_point);
}

void PointFeature::evaluate(const Eigen::Matrix3Xd& positions,
                            Eigen::Ref<Eigen::VectorXd> value) noexcept {
  value = position(0, positions);
}

void PointFeature::error(const Eigen::Ref<const Eigen::VectorXd>& value,
                         const Eigen::Ref<const Eigen::VectorXd>& target,
                         Eigen::Ref<Eigen::VectorXd> error) const noexcept {
  for (int row = 0; row < dimension(); ++row) {
    error[row] = target[components_[row]] - value[components_[row]];
  }
}

}  // namespace palpate::shape
