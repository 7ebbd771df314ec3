#include "core/elasticity/rigid_blend.hpp"

#include <algorithm>
#include <limits>

namespace palpate::elasticity {

RigidBlend::RigidBlend(const Body& body)
    : rest_(body.mesh.nodes),
      distance2_(Eigen::Matrix3Xd::Constant(3, rest_.cols(), std::numeric_limits<double>::max())) {
  const auto measure = [&](int row, const std::vector<int>& nodes) {
    for (int i = 0; i < rest_.cols(); ++i) {
      for (int node : nodes) {
        const double d = (rest_.col(i) - rest_.col(node)).squaredNorm();
        distance2_(row, i) = std::min(distance2_(row, i), d);
      }
    }
  };
  for (std::size_t g = 0; g < body.grasps.size(); ++g) {
    measure(static_cast<int>(g), body.grasps[g].nodes);
  }
  measure(2, body.fixed_nodes);
}

Eigen::Vector3d RigidBlend::position(int node, const std::array<bool, 2>& held,
                                     const std::array<math::Pose, 2>& motions) const noexcept {
  const Eigen::Vector3d at_rest = rest_.col(node);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double weights = 0;
  for (int k = 0; k < 3; ++k) {
    const bool present = k == 2 || held[k];
    if (!present || distance2_(k, node) == std::numeric_limits<double>::max()) continue;
    const double weight = 1 / std::max(distance2_(k, node), 1e-18);
    sum += weight * (k == 2 ? at_rest : Eigen::Vector3d(motions[k] * at_rest));
    weights += weight;
  }
  return weights > 0 ? Eigen::Vector3d(sum / weights) : at_rest;
}

}  // namespace palpate::elasticity
