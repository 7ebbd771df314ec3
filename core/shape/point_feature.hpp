#pragma once

#include "core/shape/material_feature.hpp"

namespace palpate::shape {

/// Position of one material point in O, m. Value and target are the whole position (3); error and
/// Jacobian hold only the components that are to be controlled.
class PointFeature : public MaterialFeature {
 public:
  struct Options {
    Eigen::Vector3d rest_point = Eigen::Vector3d::Zero();  // in O, m
    std::vector<int> components{0, 1, 2};                  // of 0 = x, 1 = y, 2 = z; each once
  };

  /// Throws std::invalid_argument where the point is not of the mesh or the components are not
  /// a non-empty list of different axes.
  PointFeature(const mesh::ElementMesh& mesh, const Options& options);

  const char* kind() const noexcept override { return "point"; }
  int value_count() const noexcept override { return 3; }
  void evaluate(const Eigen::Matrix3Xd& positions,
                Eigen::Ref<Eigen::VectorXd> value) noexcept override;
  void error(const Eigen::Ref<const Eigen::VectorXd>& value,
             const Eigen::Ref<const Eigen::VectorXd>& target,
             Eigen::Ref<Eigen::VectorXd> error) const noexcept override;

 private:
  std::vector<int> components_;
};

/// Throws std::invalid_argument unless `components` is a non-empty list of different ones of 0, 1,
/// 2; `kind` is the feature's name for the text.
const std::vector<int>& checked_components(const char* kind, const std::vector<int>& components);

}  // namespace palpate::shape
