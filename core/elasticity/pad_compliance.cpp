#include "core/elasticity/pad_compliance.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace palpate::elasticity {

math::Matrix6d pad_compliance(const Body& body, const GraspRegion& grasp,
                              const mesh::Surface& surface, double stiffness) {
  if (!(stiffness > 0)) throw std::invalid_argument("the stiffness of pads must be positive");
  if (std::isinf(stiffness)) return math::Matrix6d::Zero();
  std::vector<bool> is_held(static_cast<std::size_t>(body.mesh.node_count()), false);
  for (const int node : grasp.nodes) is_held[static_cast<std::size_t>(node)] = true;

  // springs at the midpoints of the sides integrate quadratic functions over a triangle exactly
  math::Matrix6d K = math::Matrix6d::Zero();
  double total = 0;
  const math::Pose X_GO = grasp.X_OG_rest.inverse();
  for (int t = 0; t < surface.triangles.cols(); ++t) {
    Eigen::Matrix3d corners;
    bool held = true;
    for (int i = 0; i < 3; ++i) {
      const int node = surface.triangles(i, t);
      held = held && is_held[static_cast<std::size_t>(node)];
      corners.col(i) = X_GO * Eigen::Vector3d(body.mesh.nodes.col(node));
    }
    if (!held) continue;
    const double area =
        0.5 * (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0)).norm();
    total += area;
    for (int i = 0; i < 3; ++i) {
      Eigen::Matrix<double, 3, 6> moved;  // displacement of the point per motion of G
      moved << Eigen::Matrix3d::Identity(),
          -math::cross_matrix(0.5 * (corners.col(i) + corners.col((i + 1) % 3)));
      K += area / 3 * moved.transpose() * moved;
    }
  }
  const double size = std::sqrt(total);
  math::Vector6d scale = math::Vector6d::Ones();
  scale.tail<3>().setConstant(1 / std::max(size, 1e-12));
  K = (scale.asDiagonal() * K * scale.asDiagonal() / std::max(total, 1e-300)).eval();
  const Eigen::LDLT<math::Matrix6d> factor(K);
  if (!(factor.vectorD().minCoeff() > 1e-6))
    throw std::invalid_argument("the grasp has too little surface for pads");
  const math::Matrix6d inverse = factor.solve(math::Matrix6d::Identity());
  return scale.asDiagonal() * inverse * scale.asDiagonal() / stiffness;
}

}  // namespace palpate::elasticity
