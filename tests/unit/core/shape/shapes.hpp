#pragma once

#include <cstdint>

#include "core/math/random.hpp"
#include "core/shape/feature.hpp"

namespace palpate::shape {

/// A bar along x, 0.5 x 0.06 x 0.06 m.
inline mesh::ElementMesh bar(mesh::ElementOrder order) {
  return mesh::make_element_mesh(mesh::make_box({0.5, 0.06, 0.06}, {6, 2, 2}), order);
}

/// A smooth large deformation with some noise, to avoid special cases.
inline Eigen::Matrix3Xd deformed(const mesh::ElementMesh& mesh, std::uint64_t seed = 7) {
  math::Random random(seed);
  const auto draw = [&](double size) {
    return Eigen::Vector3d(random.uniform(-size, size), random.uniform(-size, size),
                           random.uniform(-size, size));
  };
  const Eigen::Vector3d twist = Eigen::Vector3d(0.5, -2, 1.5) + draw(1);
  const Eigen::Vector3d shift = draw(0.03);
  Eigen::Matrix3Xd x = mesh.nodes;
  for (int i = 0; i < x.cols(); ++i) {
    x.col(i) = math::exp_rotation(x(0, i) * twist) * x.col(i) + shift + draw(1e-3);
  }
  return x;
}

/// Largest difference between the analytic Jacobian and central differences of error(), relative to
/// the largest entry. error(value, target) decreases as the feature moves, hence the sign.
inline double jacobian_error(Feature& feature, Eigen::Matrix3Xd x) {
  Eigen::VectorXd value(feature.value_count());
  Eigen::VectorXd ahead = value, behind = value;
  feature.evaluate(x, value);
  const Eigen::MatrixXd analytic = feature.jacobian();
  Eigen::MatrixXd numeric(feature.dimension(), analytic.cols());
  Eigen::VectorXd difference(feature.dimension());
  const double h = 1e-6;
  for (int i = 0; i < static_cast<int>(feature.support().size()); ++i) {
    for (int k = 0; k < 3; ++k) {
      double& coordinate = x(k, feature.support()[i]);
      const double middle = coordinate;
      coordinate = middle + h;
      feature.evaluate(x, ahead);
      coordinate = middle - h;
      feature.evaluate(x, behind);
      coordinate = middle;
      feature.error(behind, ahead, difference);
      numeric.col(3 * i + k) = difference / (2 * h);
    }
  }
  return (numeric - analytic).cwiseAbs().maxCoeff() / analytic.cwiseAbs().maxCoeff();
}

}  // namespace palpate::shape
