#pragma once

#include "core/shape/feature.hpp"

namespace palpate::control {

/// J = sum over the support of (d feature / d x_i) (d x_i / d xi). `node_motion(node)` gives the
/// 3 x 6 block d x_i / d xi. Allocates nothing.
template <class NodeMotion>
void accumulate_support(const shape::Feature& feature, const NodeMotion& node_motion,
                        Eigen::Ref<Eigen::MatrixXd> J) noexcept {
  J.setZero();
  const Eigen::MatrixXd& H = feature.jacobian();
  const std::vector<int>& support = feature.support();
  for (int i = 0; i < static_cast<int>(support.size()); ++i) {
    const Eigen::Matrix<double, 3, 6> block = node_motion(support[i]);
    J += H.middleCols<3>(3 * i).lazyProduct(block);
  }
}

}  // namespace palpate::control
