#pragma once

#include "core/shape/material_feature.hpp"

namespace palpate::shape {

/// Position of one material point in O, m. Value and target are the whole position (3); error and
/// Jacobian contain only the controlled components.
class PointFeature : public MaterialFeature {
 public:
  struct Options {
    Eigen::Vector3d rest_point = Eigen::Vector3d::Zero();  // in O, m
    /// Distinct entries of 0 = x, 1 = y, 2 = z.
    std::vector<int> components{0, 1, 2};
  };

  /// Throws std::invalid_argument if the point is not on the mesh or the components are not a
  /// non-empty list of different axes.
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

/// Throws std::invalid_argument unless `components` is a non-empty list of distinct values of 0, 1,
/// 2; `kind` is the feature's name for the message.
const std::vector<int>& checked_components(const char* kind, const std::vector<int>& components);

}  // namespace palpate::shape
